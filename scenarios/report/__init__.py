"""What a person reads in a terminal about one experiment or one run. Computes nothing that a result does not hold."""
