"""The multi-frame linear regressive filter of the 2018 paper, with its noise derived."""
