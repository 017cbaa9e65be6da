# SPDX-License-Identifier: MIT
"""DICOM with several images at each place, and with tags that are easily misread, by pydicom, for
tests/test_dicom.sh.

    kinds.py FOLDER     makes the files there; of a series NAME, volume N has the twin NAME-N"""
import copy
import os
import random
import sys

import numpy
import pydicom
import pydicom.data
import pydicom.datadict
from pydicom.dataset import Dataset
from pydicom.sequence import Sequence

from make import (LPS, PLACE, SECRETS, forget, identify, read, run, save_plain_twin, save_twin,
                  slices_of, voxels, write)

SLICES = 5
MR, ENHANCED = "1.2.840.10008.5.1.4.1.1.4", "1.2.840.10008.5.1.4.1.1.4.1"
LENGTH = numpy.linalg.norm(PLACE[:3, :3], axis=0)


def data_of(volume):
    return (voxels()[:, :, :SLICES] + 1000 * volume).astype(numpy.int16)


# ---- one file a slice ----


def images_of(volumes):
    """images[v][z], of tags by volume; a tag that is a function is asked for each slice, and one
    that is None is not there. Numbers are used once for each volume."""
    images = []
    for v, tags in enumerate(volumes):
        images.append(slices_of(data_of(v), PLACE))
        for z, one in enumerate(images[v]):
            one.SOPClassUID = one.file_meta.MediaStorageSOPClassUID = MR
            one.Modality = "MR"
            one.InstanceNumber = z + 1
            identify(one, ".6.%d.%d" % (v, z))
            forget(one, "AcquisitionNumber", "AcquisitionTime", "AcquisitionDate", "ContentTime",
                   "ContentDate", "ImageType", "SliceLocation", "KVP")
            for name, value in tags.items():
                value = value(z) if callable(value) else value
                if value is not None:
                    setattr(one, name, value)
    return images


def save(path, images):
    """Under names in no order."""
    os.mkdir(path)
    images = [one for volume in images for one in volume]
    names = list(range(len(images)))
    random.Random(len(path)).shuffle(names)
    for i, one in zip(names, images):
        one.save_as("%s/IM%03d" % (path, i))
    return path


def save_twins(path, volumes):
    """In the order that the volumes are to have."""
    for n, v in enumerate(volumes):
        save_twin("%s-%d" % (path, n), data_of(v), PLACE, 2, -1000)


# ---- one file of all slices ----


def enhanced_of(volumes, pointers=()):
    """Frames in no order. Of each volume: group sequence -> its tags, to be nested so."""
    one = copy.deepcopy(slices_of(data_of(0), PLACE)[0])
    place = [str(number) for number in one.ImageOrientationPatient]
    one.SOPClassUID = one.file_meta.MediaStorageSOPClassUID = ENHANCED
    forget(one, "ImagePositionPatient", "ImageOrientationPatient", "PixelSpacing",
           "SliceThickness", "RescaleSlope", "RescaleIntercept", "SliceLocation",
           "AcquisitionNumber", "AcquisitionTime", "ContentTime", "ImageType", "KVP")
    axes, measures, values, shared = Dataset(), Dataset(), Dataset(), Dataset()
    axes.ImageOrientationPatient = place
    measures.PixelSpacing, measures.SliceThickness = [str(LENGTH[1]), str(LENGTH[0])], "2.5"
    values.RescaleSlope, values.RescaleIntercept, values.RescaleType = 2, -1000, "US"
    shared.PlaneOrientationSequence = Sequence([axes])
    shared.PixelMeasuresSequence = Sequence([measures])
    shared.PixelValueTransformationSequence = Sequence([values])
    one.SharedFunctionalGroupsSequence = Sequence([shared])
    one.DimensionIndexSequence = Sequence([])
    for tag in pointers:
        item = Dataset()
        item.DimensionIndexPointer = tag
        one.DimensionIndexSequence.append(item)
    frames = [(v, z) for v in range(len(volumes)) for z in range(SLICES)]
    random.Random(7).shuffle(frames)
    groups, pixels = [], []
    for v, z in frames:
        group, position = Dataset(), Dataset()
        at = LPS @ PLACE @ [0, 0, z, 1]
        position.ImagePositionPatient = ["%.10g" % n for n in at[:3]]
        group.PlanePositionSequence = Sequence([position])
        for sequence, tags in volumes[v].items():
            item = Dataset()
            for name, value in tags.items():
                setattr(item, name, value(z) if callable(value) else value)
            setattr(group, sequence, Sequence([item]))
        groups.append(group)
        pixels.append(data_of(v)[:, :, z].T.astype("<i2").tobytes())
    one.PerFrameFunctionalGroupsSequence = Sequence(groups)
    one.NumberOfFrames = len(groups)
    one.PixelData = b"".join(pixels)
    return one


def gradient(*numbers):
    item = Dataset()
    item.DiffusionGradientOrientation = list(numbers)
    return Sequence([item])


# ---- what tells volumes apart ----

PHASE, MAGNITUDE = ["ORIGINAL", "PRIMARY", "P", "ND"], ["ORIGINAL", "PRIMARY", "M", "ND"]


def clock(volume, step=1):
    """Times of slices that are acquired one by one, odd ones first, volume after volume."""
    return lambda z: "1015%02d.%02d" % (volume, step * (z // 2 + z % 2 * 3))


def make_keys():
    """Each by one tag alone, with the volumes in another order than they are to have."""
    b = "DiffusionBValue"
    keys = {
        "echo": [{"EchoTime": 9.84}, {"EchoTime": 4.92}],
        "echo-number": [{"EchoNumbers": 10}, {"EchoNumbers": 9}],
        "b": [{b: 1000.0}, {b: 0.0}, {b: 500.0}],
        "b-missing": [{b: 1000.0}, {b: None}],
        "gradient": [{b: 700.0, "DiffusionGradientOrientation": [0.0, 1.0, 0.0]},
                     {b: 700.0, "DiffusionGradientOrientation": [0.0, 0.0, 1.0]}, {b: 0.0}],
        "phase": [{"ImageType": PHASE}, {"ImageType": MAGNITUDE}],
        "derived": [{"ImageType": ["DERIVED", "PRIMARY", "ADC"]},
                    {"ImageType": ["ORIGINAL", "PRIMARY", "DIFFUSION"]}],
        "inversion": [{"InversionTime": 2500}, {"InversionTime": 900}],
        "flip": [{"FlipAngle": 20}, {"FlipAngle": 4}],
        "trigger": [{"TriggerTime": lambda z: "%.1f" % (500 + 3 * z)},
                    {"TriggerTime": lambda z: "%.1f" % (20 - 2 * z)}],
        "temporal": [{"TemporalPositionIdentifier": 11}, {"TemporalPositionIdentifier": 2}],
        "acquisition": [{"AcquisitionNumber": 10}, {"AcquisitionNumber": 9}],
        "time": [{"AcquisitionTime": clock(30)}, {"AcquisitionTime": clock(8)}],
        "midnight": [{"AcquisitionTime": lambda z: "000%d10" % z, "AcquisitionDate": "20200301"},
                     {"AcquisitionTime": lambda z: "235%d10" % z, "AcquisitionDate": "20200229"}],
        "content": [{"ContentTime": clock(3)}, {"ContentTime": clock(2)}],
    }
    orders = {"b": [1, 2, 0], "gradient": [2, 1, 0]}
    for name, volumes in keys.items():
        save_twins(save(name, images_of(volumes)), orders.get(name, [1, 0]))
    both = [{"EchoTime": te, "ImageType": kind} for kind in (PHASE, MAGNITUDE) for te in (9, 5)]
    save_twins(save("echo-phase", images_of(both)), [3, 1, 2, 0])
    # Images of b 0 that are there twice, told apart by the number of their acquisition alone.
    twice = [{b: 0.0, "AcquisitionNumber": 3}, {b: 800.0, "AcquisitionNumber": 2},
             {b: 0.0, "AcquisitionNumber": 1}]
    save_twins(save("b-twice", images_of(twice)), [2, 0, 1])


def make_enhanced():
    content, echo, diffusion = "FrameContentSequence", "MREchoSequence", "MRDiffusionSequence"
    keys = {
        "echo": [{echo: {"EffectiveEchoTime": 9.84}}, {echo: {"EffectiveEchoTime": 4.92}}],
        "b": [{diffusion: {"DiffusionBValue": n}} for n in (1000.0, 0.0, 500.0)],
        "gradient": [{diffusion: {"DiffusionBValue": 700.0,
                                  "DiffusionGradientDirectionSequence": gradient(0.0, 1.0, 0.0)}},
                     {diffusion: {"DiffusionBValue": 700.0,
                                  "DiffusionGradientDirectionSequence": gradient(0.0, 0.0, 1.0)}},
                     {diffusion: {"DiffusionBValue": 0.0}}],
        "phase": [{"MRImageFrameTypeSequence": {"FrameType": kind}}
                  for kind in (PHASE, MAGNITUDE)],
        "component": [{"MRImageFrameTypeSequence": {"ComplexImageComponent": kind}}
                      for kind in ("PHASE", "MAGNITUDE")],
        "inversion": [{"MRModifierSequence": {"InversionTimes": n}} for n in (2500.0, 900.0)],
        "trigger": [{"CardiacSynchronizationSequence": {
            "NominalCardiacTriggerDelayTime": lambda z, n=n: n + 3.0 * z}} for n in (500, 20)],
        "temporal": [{content: {"TemporalPositionIndex": n}} for n in (11, 2)],
        "acquisition": [{content: {"FrameAcquisitionNumber": n}} for n in (10, 9)],
        "time": [{content: {"FrameAcquisitionDateTime": lambda z, n=n: "20200229" + clock(n)(z)}}
                 for n in (30, 8)],
        "index": [{content: {"DimensionIndexValues": lambda z, n=n: [1, z + 1, n]}}
                  for n in (2, 1)],
    }
    orders = {"b": [1, 2, 0], "gradient": [2, 1, 0]}
    for name, volumes in keys.items():
        path = "enhanced-" + name
        enhanced_of(volumes, (0x00209056, 0x00209057, 0x00209128)).save_as(path)
        save_twins(path, orders.get(name, [1, 0]))


def make_numbers():
    """Volumes that nothing but InstanceNumber divides, or not even that."""
    for name, number in (("numbers", lambda v, z: 40 - 20 * v + z),
                         ("numbers-by-place", lambda v, z: 90 - 2 * z - v),
                         ("jumbled", lambda v, z: (7 * (SLICES * v + z)) % 11),
                         ("used-twice", lambda v, z: z + 1)):
        path = save(name, images_of(
            [{"InstanceNumber": lambda z, v=v: number(v, z)} for v in range(2)]))
        save_twins(path, [1, 0])
    # InstanceNumber does not decide where another tag differs, and that tag does not either.
    save("both-differ", images_of(
        [{"InstanceNumber": lambda z, v=v: 20 * v + z,
          "ContentTime": lambda z, v=v: "1010%02d" % (7 * (SLICES * v + z) % 11)}
         for v in range(2)]))
    enhanced_of([{}, {}]).save_as("frames")
    # An echo whose volumes are whole, in which kinds of images are mixed.
    save("mixed-kinds", images_of(
        [{"EchoTime": 5 + v, "ImageType": lambda z, v=v: (PHASE, MAGNITUDE)[(z > 2) ^ v]}
         for v in range(2)]))
    save("one-wrong", images_of(
        [{"DiffusionBValue": lambda z, v=v: 1000.0 * v * (z != 3),
          "InstanceNumber": lambda z, v=v: 20 * v + z} for v in range(2)]))
    images = images_of([{"EchoTime": 5}, {"EchoTime": 9}])
    del images[1][2]
    save("incomplete", images)
    # A type that differs from slice to slice, and from no other image of its place.
    save("by-slice", images_of([{"ImageType": lambda z: (PHASE, MAGNITUDE)[z % 2]}]))
    save_twin("by-slice", data_of(0), PLACE, 2, -1000)


# ---- numbers that are easily misread ----


def make_values():
    def series(name, change, data=None, scale=(2, -1000)):
        images = images_of([{}])
        for z, one in enumerate(images[0]):
            change(one, z)
        save(name, images)
        if data is not None:
            save_twin(name, data, PLACE, *scale)

    def lookup(one, first=-90, bits=16, count=1000):
        item = Dataset()
        table = numpy.arange(count) * 2 + 5
        item.add_new(0x00283002, "SS", [count, first, bits])
        item.LUTExplanation = "numbers"
        item.add_new(0x00283006, "OW", (table.astype("<u2") if bits > 8 else
                                        (table % 256).astype("u1")).tobytes())
        one.ModalityLUTSequence = Sequence([item])
        del one.RescaleSlope, one.RescaleIntercept

    plain = data_of(0)
    looked = numpy.clip(plain.astype(int) + 90, 0, 999) * 2 + 5
    series("lookup", lambda one, z: lookup(one), looked.astype(numpy.float32), (1, 0))
    series("lookup-short", lambda one, z: lookup(one, -40, 16, 300),
           (numpy.clip(plain.astype(int) + 40, 0, 299) * 2 + 5).astype(numpy.float32), (1, 0))
    series("lookup-bytes", lambda one, z: lookup(one, -90, 8),
           (looked % 256).astype(numpy.float32), (1, 0))

    def cut_lookup(one, z):
        lookup(one)
        one.ModalityLUTSequence[0].add_new(0x00283006, "OW", bytes(200))
    series("lookup-cut", cut_lookup)

    def lookup_and_slope(one, z):
        lookup(one)
        one.RescaleSlope = 2
    series("lookup-slope", lookup_and_slope)

    series("slope-0", lambda one, z: setattr(one, "RescaleSlope", 0), plain, (1, 0))
    series("slope-0-once", lambda one, z: setattr(one, "RescaleSlope", min(z, 1)))

    series("one-object", lambda one, z: identify(one, ".7"), plain)
    images = images_of([{"EchoTime": 5}, {"EchoTime": 9}])
    for one in images[0] + images[1]:
        identify(one, ".7")
    save_twins(save("one-object-echoes", images), [0, 1])
    images = images_of([{}, {}])  # of the same places and tags, and other pixels
    for z in range(SLICES):
        images[1][z].SOPInstanceUID = images[0][z].SOPInstanceUID
    save("one-object-pixels", images)
    # A copy that is packed in another way.
    series("packed-copy", lambda one, z: None, plain)
    run("dcmcrle", "packed-copy/IM002", "packed-copy/copy")
    # Decimal commas, in each number that is read.
    commas = {"RescaleSlope": b"1,5 ", "RescaleIntercept": b"-0,5", "PixelSpacing": b"0,9\\0,9 ",
              "ImagePositionPatient": b"1,5\\2,5\\3,5 ",
              "ImageOrientationPatient": b"1\\0\\0\\0\\1\\0,0 ", "SliceThickness": b"2,5 ",
              "SpacingBetweenSlices": b"2,5 ", "EchoTime": b"4,92", "SliceLocation": b"3,5 "}
    for name, text in commas.items():
        images = images_of([{}])
        one = images[0][2]
        setattr(one, name, [1, 2] if name == "PixelSpacing" else
                [1, 2, 3] if name == "ImagePositionPatient" else
                [1, 0, 0, 0, 1, 0] if name == "ImageOrientationPatient" else 7)
        path = save("comma-" + name, images)
        saved = [os.path.join(path, file) for file in os.listdir(path)
                 if pydicom.dcmread(os.path.join(path, file)).InstanceNumber == 3][0]
        write_text(saved, pydicom.datadict.tag_for_keyword(name), text)
    enhanced_of([{}]).save_as("comma-enhanced")
    write_text("comma-enhanced", 0x00281053, b"1,5 ")


def write_text(path, tag, text):
    """In place of the value that an element of explicit VR has."""
    data = read(path)
    at = data.index((tag >> 16).to_bytes(2, "little") + (tag & 0xffff).to_bytes(2, "little") +
                    b"DS")
    length = int.from_bytes(data[at + 6:at + 8], "little")
    if b"\x2a\x00\x00\x52" in data or b"\x00\x52\x30\x92" in data:  # a sequence has its length
        text = text.ljust(length)[:length]
    write(path, data[:at + 6], len(text).to_bytes(2, "little"), text, data[at + 8 + length:])


# ---- slices without a place ----


def make_unplaced():
    data = data_of(0)

    def series(name, twin=None, **tags):
        images = images_of([tags])
        for one in images[0]:
            del one.ImagePositionPatient, one.ImageOrientationPatient
            one.SpacingBetweenSlices = "%.10g" % LENGTH[2]
            one.RescaleSlope, one.RescaleIntercept = 1, 0
            if "InstanceNumber" not in tags:
                del one.InstanceNumber
        save(name, images)
        if twin is not None:
            save_plain_twin(name, twin, LENGTH)
    up, down = (lambda z: 30 + LENGTH[2] * z), (lambda z: 30 - LENGTH[2] * z)
    turned = numpy.ascontiguousarray(data[:, :, ::-1])
    series("location", data, SliceLocation=up)
    series("location-down", turned, SliceLocation=down)
    series("location-numbers", data, SliceLocation=down, InstanceNumber=lambda z: z + 4)
    series("location-jumbled", data, SliceLocation=up, InstanceNumber=lambda z: (3 * z) % 5)
    series("numbers-alone", data, InstanceNumber=lambda z: z + 1)
    series("location-once", data, SliceLocation=7, InstanceNumber=lambda z: z + 1)
    series("location-gap", SliceLocation=lambda z: up(z + (z > 2)))
    series("nothing")
    one = enhanced_of([{"FrameContentSequence": {"TemporalPositionIndex": lambda z: z + 1}}])
    for group in one.PerFrameFunctionalGroupsSequence:
        del group.PlanePositionSequence
    one.save_as("frames-unplaced")


# ---- objects that are no images ----


def make_objects():
    os.mkdir("objects")
    rows = {"seg": "66.4", "parametric": "30",
            "rtstruct": "481.3", "rtplan": "481.5", "report": "88.33", "pdf": "104.1",
            "state": "11.1", "surface": "66.5", "registration": "66.1", "spectrum": "4.2"}
    for name, number in rows.items():
        has_pixels = name in ("seg", "parametric")
        one = enhanced_of([{}]) if has_pixels else images_of([{}])[0][0]
        one.SOPClassUID = "1.2.840.10008.5.1.4.1.1." + number
        one.file_meta.MediaStorageSOPClassUID = one.SOPClassUID
        one.SeriesInstanceUID = SECRETS[3] + ".9"
        if not has_pixels:
            del one.PixelData, one.Rows, one.Columns
        if has_pixels and name != "parametric":
            one.BitsAllocated = one.BitsStored = 8
            one.HighBit, one.PixelRepresentation = 7, 0
            one.PixelData = one.PixelData[::2]
        one.save_as("objects/%s.dcm" % name)


os.chdir(sys.argv[1])
for make in (make_keys, make_enhanced, make_numbers, make_values, make_unplaced, make_objects):
    make()
