"""One module per rule: open artifacts, make one library call, save. Scripts and command line share them."""
