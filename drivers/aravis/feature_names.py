"""By which names cameras go for the settings that we need, the standard one first.

Source: GenICam Standard Features Naming Convention (SFNC) 2.x; its older `...Abs` and `...Raw`.
"""

EXPOSURE_US = ("ExposureTime", "ExposureTimeAbs")
LINE_RATE_HZ = ("AcquisitionLineRate", "AcquisitionLineRateAbs", "LineRate")
FRAME_RATE_HZ = ("AcquisitionFrameRate", "AcquisitionFrameRateAbs")
GAIN_DB = ("Gain", "GainAbs")
GAIN_RAW = ("GainRaw",)
BLACK_LEVEL_DN = ("BlackLevel", "BlackLevelAbs")
BLACK_LEVEL_RAW = ("BlackLevelRaw",)
ROWS = ("Height",)
"""Of a frame: an area camera's rows, a linescan camera's lines."""
COLUMNS = ("Width",)
FIRST_COLUMN = ("OffsetX",)
FIRST_ROW = ("OffsetY",)
SCAN_KIND = ("DeviceScanType",)
PIXEL_FORMAT = ("PixelFormat",)
TEMPERATURE_C = ("DeviceTemperature", "TemperatureAbs", "SensorTemperature")
BYTE_ORDER = ("DeviceStreamChannelEndianness",)
LOCK = ("TLParamsLocked",)

AUTOMATIC = ("ExposureAuto", "GainAuto", "BlackLevelAuto", "TestPattern", "TestImageSelector")
"""What would change the pixels behind our back; all have an entry `Off`."""
