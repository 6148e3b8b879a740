"""GigE Vision and USB3 Vision through Aravis, and a simulated GigE Vision camera."""
