"""Parameters of every trial and their distribution over trials, the paper's way and Bayes'."""
