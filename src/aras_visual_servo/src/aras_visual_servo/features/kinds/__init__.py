"""More kinds of features, each in a file of its own."""
