"""One module per rule: open artifacts, make one library call, save.

The scripts of the workflow and the command line share them.
"""
