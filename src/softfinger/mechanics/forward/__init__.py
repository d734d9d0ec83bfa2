"""One forward model of the quasi-static finger, in which all left-out physics is a slot.

`slots` lists every term and its null value, `simulate` is the face, the rest the compiled kernel.
"""
