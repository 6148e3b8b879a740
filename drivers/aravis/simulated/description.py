"""The simulated camera's GenICam description: a linescan or area camera over its registers.

Source: GenICam Standard Features Naming Convention (SFNC) 2.x for the names; the older dialect
uses those of SFNC 1.x, which many cameras in the field still speak.
"""

from typing import Literal
from xml.etree.ElementTree import Element, SubElement, tostring

from drivers.aravis.simulated import xml_nodes as nodes
from drivers.aravis.simulated.registers import (
    DEVICE_VERSION,
    MODEL_NAME,
    SERIAL_NUMBER,
    VENDOR_NAME,
    Register,
)
from drivers.mock.limits import CameraLimits
from drivers.pixel_formats import FORMATS

Dialect = Literal["sfnc2", "sfnc1"]


def described(limits: CameraLimits, dialect: Dialect = "sfnc2") -> str:
    """Return the description, an XML document, of a camera with `limits`."""
    root = Element(
        "RegisterDescription",
        {
            "ModelName": "Linescan",
            "VendorName": "darkflat",
            "ToolTip": "simulated linescan camera",
            "StandardNameSpace": "GEV",
            "SchemaMajorVersion": "1",
            "SchemaMinorVersion": "1",
            "SchemaSubMinorVersion": "0",
            "MajorVersion": "1",
            "MinorVersion": "0",
            "SubMinorVersion": "0",
            "ProductGuid": "0",
            "VersionGuid": "0",
            "xmlns": "http://www.genicam.org/GenApi/Version_1_1",
        },
    )
    groups = {
        "DeviceControl": _device(root, limits),
        "ImageFormatControl": _image(root, limits),
        "AcquisitionControl": _acquisition(root, limits, dialect),
        "AnalogControl": _analog(root, limits, dialect),
        "TransportLayerControl": _transport(root),
    }
    nodes.category(root, "Root", tuple(groups))
    for name, features in groups.items():
        nodes.category(root, name, features)
    SubElement(root, "Port", Name="Device", NameSpace="Standard")
    return '<?xml version="1.0" encoding="utf-8"?>\n' + tostring(root, encoding="unicode")


def _device(root: Element, limits: CameraLimits) -> tuple[str, ...]:
    texts = {
        "DeviceVendorName": VENDOR_NAME,
        "DeviceModelName": MODEL_NAME,
        "DeviceVersion": DEVICE_VERSION,
        "DeviceSerialNumber": SERIAL_NUMBER,
        "DeviceID": SERIAL_NUMBER,
    }
    for name, at in texts.items():
        nodes.text(root, name, at)
    nodes.only_choice(root, "DeviceScanType", "Linescan" if limits.rows is None else "Areascan")
    nodes.only_choice(root, "DeviceStreamChannelEndianness", "Little")
    nodes.measured(root, "DeviceTemperature", Register.TEMPERATURE_C, "C")
    return (*texts, "DeviceScanType", "DeviceStreamChannelEndianness", "DeviceTemperature")


def _image(root: Element, limits: CameraLimits) -> tuple[str, ...]:
    step = limits.column_step
    nodes.constant(root, "SensorWidth", limits.columns)
    nodes.constant(root, "WidthMax", limits.columns)  # by SFNC, whatever the offset is
    nodes.formula(root, "IntSwissKnife", "WidthLeft", f"{limits.columns} - X", X="OffsetXReg")
    nodes.formula(root, "IntSwissKnife", "OffsetXMax", f"{limits.columns} - W", W="WidthReg")
    nodes.integer(
        root, "Width", Register.WIDTH, low=step, high="WidthLeft", step=step, lockable=True
    )
    nodes.integer(
        root, "OffsetX", Register.OFFSET_X, low=0, high="OffsetXMax", step=step, lockable=True
    )
    heights = _height(root, limits)
    codes = {str(name): FORMATS[name].pfnc for name in limits.formats}
    nodes.choice(root, "PixelFormat", Register.PIXEL_FORMAT, codes, lockable=True)
    return ("SensorWidth", "WidthMax", "Width", "OffsetX", *heights, "PixelFormat")


def _height(root: Element, limits: CameraLimits) -> tuple[str, ...]:
    """Add what tells and sets the height: lines of a frame, or an area camera's rows."""
    nodes.constant(root, "SensorHeight", limits.rows or 1)
    if limits.rows is None:
        highest = int(limits.frame_lines.high)
        nodes.integer(root, "Height", Register.HEIGHT, low=1, high=highest, lockable=True)
        return ("SensorHeight", "Height")
    nodes.constant(root, "HeightMax", limits.rows)
    nodes.formula(root, "IntSwissKnife", "HeightLeft", f"{limits.rows} - Y", Y="OffsetYReg")
    nodes.formula(root, "IntSwissKnife", "OffsetYMax", f"{limits.rows} - H", H="HeightReg")
    nodes.integer(root, "Height", Register.HEIGHT, low=1, high="HeightLeft", lockable=True)
    nodes.integer(root, "OffsetY", Register.OFFSET_Y, low=0, high="OffsetYMax", lockable=True)
    return ("SensorHeight", "HeightMax", "Height", "OffsetY")


def _acquisition(root: Element, limits: CameraLimits, dialect: Dialect) -> tuple[str, ...]:
    suffix = "" if dialect == "sfnc2" else "Abs"
    exposure, line_rate = f"ExposureTime{suffix}", f"AcquisitionLineRate{suffix}"
    frame_rate = "AcquisitionFrameRate"
    rate = line_rate if limits.rows is None else frame_rate
    nodes.formula(root, "SwissKnife", "ExposureMax", "P / 100.0", P=f"{rate}Reg")
    nodes.formula(root, "SwissKnife", "RateMax", "100000000.0 / E", E=f"{exposure}Reg")
    nodes.scaled(
        root, exposure, Register.EXPOSURE_10NS, unit="us", register_low=1,
        to_register="ROUND(FROM * 100, 0)", from_register="TO / 100.0",
        low=limits.exposure_us.low, high="ExposureMax",
    )  # fmt: skip
    nodes.scaled(
        root, rate, Register.LINE_PERIOD_10NS, unit="Hz", register_low=1,
        to_register="ROUND(100000000 / FROM, 0)", from_register="100000000.0 / TO",
        low=1e6 / limits.line_period_us.high, high="RateMax",
    )  # fmt: skip
    if limits.rows is None:
        nodes.formula(
            root, "SwissKnife", frame_rate, "100000000.0 / (P * H)",
            P=f"{rate}Reg", H="HeightReg",
        )  # fmt: skip
    nodes.only_choice(root, "ExposureMode", "Timed")
    modes = {"Continuous": 1, "SingleFrame": 2, "MultiFrame": 3}
    nodes.choice(root, "AcquisitionMode", Register.ACQUISITION_MODE, modes)
    running = nodes.register(root, "AcquisitionReg", Register.ACQUISITION)
    nodes.command(root, "AcquisitionStart", running, 1)
    nodes.command(root, "AcquisitionStop", running, 0)
    nodes.only_choice(root, "TriggerSelector", "FrameStart")
    nodes.choice(root, "TriggerMode", Register.TRIGGER_MODE, {"Off": 0, "On": 1})
    nodes.choice(root, "TriggerSource", Register.TRIGGER_SOURCE, {"Line0": 0, "Software": 1})
    return (
        "AcquisitionMode", "AcquisitionStart", "AcquisitionStop",
        *dict.fromkeys((frame_rate, rate)), "ExposureMode", exposure,
        "TriggerSelector", "TriggerMode", "TriggerSource",
    )  # fmt: skip


def _analog(root: Element, limits: CameraLimits, dialect: Dialect) -> tuple[str, ...]:
    if dialect == "sfnc1":
        highest = round(limits.gain_db.high * 100)
        nodes.integer(root, "GainRaw", Register.GAIN_CENTIBEL, low=0, high=highest)
        highest = round(limits.black_level_dn.high * 100)
        nodes.integer(root, "BlackLevelRaw", Register.BLACK_LEVEL_CENTIDN, low=0, high=highest)
        return ("GainRaw", "BlackLevelRaw")
    for name, at, span, unit in (
        ("Gain", Register.GAIN_CENTIBEL, limits.gain_db, "dB"),
        ("BlackLevel", Register.BLACK_LEVEL_CENTIDN, limits.black_level_dn, "DN"),
    ):
        nodes.scaled(
            root, name, at, unit=unit, low=span.low, high=span.high,
            to_register="ROUND(FROM * 100, 0)", from_register="TO / 100.0",
        )  # fmt: skip
    return ("Gain", "BlackLevel")


def _transport(root: Element) -> tuple[str, ...]:
    nodes.formula(
        root, "IntSwissKnife", "PayloadSize", "(W * H * ((P >> 16) & 0xFF) + 7) / 8",
        W="WidthReg", H="HeightReg", P="PixelFormatReg",
    )  # fmt: skip
    nodes.element(
        root, "MaskedIntReg", "GevSCPSPacketSizeReg",
        Address=f"{int(Register.PACKET_SIZE):#x}", Length=4, AccessMode="RW", pPort="Device",
        Cachable="NoCache", LSB=31, MSB=16, Sign="Unsigned", Endianess="BigEndian",
    )  # fmt: skip
    nodes.element(
        root, "Integer", "GevSCPSPacketSize", pValue="GevSCPSPacketSizeReg",
        Min=576, Max=65500, Inc=4,
    )  # fmt: skip
    nodes.integer(root, "GevHeartbeatTimeout", Register.HEARTBEAT_TIMEOUT_MS, low=500, high=60000)
    nodes.integer(root, "TLParamsLocked", Register.LOCKED, low=0, high=1)
    return ("PayloadSize", "GevSCPSPacketSize", "GevHeartbeatTimeout", "TLParamsLocked")
