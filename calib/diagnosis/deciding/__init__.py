"""The deciding measurement: which plan would tell apart what a recording cannot."""
