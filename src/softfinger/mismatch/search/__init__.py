"""The search for sets of effects.

Its false alarms are part of it.
"""
