"""The rig: motor controller and camera record a campaign.

The recorder never trusts the cable: every line carries a checksum, every request is answered, and
the controller lets the wire go by itself when the recorder falls silent.
"""
