"""The rig: a serial motor controller and a camera record a campaign folder.

The recorder never trusts the cable: every line carries a checksum, every request is answered, and
the controller lets the wire go by itself when the recorder falls silent.
"""
