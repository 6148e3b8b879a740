"""Files of frames: .npy, .tif, .fits and .raw, read memory-mapped, written in a stream."""
