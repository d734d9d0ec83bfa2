"""The forward model of a finger.

It is made of wires, chain, viscoelastic elements and what may be left out of them.

Signs, stated once: joint angles are relative to the link before, counter-clockwise positive as
seen in the picture; a positive load bends positively. Parameters come in the order of `PARAMETERS`.
Nothing is compiled when this package is imported; each kernel compiles at its first call and is
cached on disk.
"""

PARAMETERS = ("k_v", "c_v", "c_p", "q_ini")
"""k_v [N m/rad], c_v [N m s/rad], c_p [N m s/rad], q_ini [rad]."""

LOG_PARAMETERS = ("log_k_v", "log_c_v", "log_c_p", "q_ini")
"""The same as inference has them: logarithms but for q_ini."""

OWN = len(PARAMETERS)
"""Numbers of one joint in a trial's own parameters."""
