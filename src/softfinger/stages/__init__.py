"""One module per rule.

A stage opens artifacts, makes one library call and saves.

The scripts of the workflow and the command line share them.
"""
