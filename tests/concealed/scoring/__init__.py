"""A diagnosis is run over the suite, then the answers are opened and it is measured."""
