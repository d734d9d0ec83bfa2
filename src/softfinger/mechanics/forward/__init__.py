"""One forward model of the quasi-static finger.

All left-out physics is a slot in it.

`simulate` is the face. Effects declare slots (`slot`), which `slots` gathers as arrays, and hooks
(`hooks`), which the compiled kernel calls; all else is the base joint and the kernel.
"""
