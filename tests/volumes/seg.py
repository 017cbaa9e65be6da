# SPDX-License-Identifier: MIT
"""DICOM SEG by pydicom, for tests/test_seg.sh.

    seg.py FOLDER       makes an oblique CT, segmentations of it, and maps of the same labels there
    seg.py corpus       makes small ones of those in the working folder, as in tests/fuzz/corpus/seg
    seg.py damage A.dcm makes copies of it with wrong bytes
    seg.py read A.dcm B.nii [FOLDER]
                        compares the voxels of a SEG and a map, place by place, and its references
                        with the series there, and prints the segments of the SEG"""
import copy
import os
import random
import sys

import nibabel
import numpy
import pydicom
from pydicom.dataset import Dataset
from pydicom.sequence import Sequence

from make import LPS, PLACE, SECRETS, SIZE, identify, save_twin, slices_of, voxels, write

SEG = "1.2.840.10008.5.1.4.1.1.66.4"
SPACING = numpy.linalg.norm(PLACE[:3, :3], axis=0)


def item(**values):
    one = Dataset()
    for name, value in values.items():
        setattr(one, name, Sequence([value]) if isinstance(value, Dataset) else value)
    return one


def code(value, scheme, meaning):
    return item(CodeValue=value, CodingSchemeDesignator=scheme, CodeMeaning=meaning)


def seg_of(slices, frames, names, bits=1, kind="BINARY", between=True):
    """frames: (segment or None, z, pixels [y][x]); the place of a frame is that of slice z."""
    one = copy.deepcopy(slices[0])
    for name in ("ImagePositionPatient", "ImageOrientationPatient", "PixelSpacing",
                 "SliceThickness", "RescaleSlope", "RescaleIntercept", "PixelData",
                 "SliceLocation", "WindowCenter", "WindowWidth", "DataSetTrailingPadding"):
        if name in one:
            delattr(one, name)
    one.SOPClassUID = one.file_meta.MediaStorageSOPClassUID = SEG if kind != "LABELMAP" else \
        "1.2.840.10008.5.1.4.1.1.66.7"
    identify(one, ".9.1")
    one.Modality, one.SeriesInstanceUID = "SEG", SECRETS[3] + ".9"
    one.SegmentationType, one.SpecificCharacterSet = kind, "ISO_IR 192"
    one.BitsAllocated = one.BitsStored = bits
    one.HighBit, one.PixelRepresentation = bits - 1, 0
    one.NumberOfFrames = len(frames)
    if kind == "FRACTIONAL":
        one.SegmentationFractionalType, one.MaximumFractionalValue = "PROBABILITY", 200
    one.SegmentSequence = Sequence([
        item(SegmentNumber=n + 1, SegmentLabel=name, SegmentAlgorithmType="MANUAL",
             RecommendedDisplayCIELabValue=[30000 + 9000 * n, 40000 - 5000 * n, 40000],
             SegmentedPropertyCategoryCodeSequence=code("85756007", "SCT", "Tissue"),
             SegmentedPropertyTypeCodeSequence=code("10200004", "SCT", "Liver"))
        for n, name in enumerate(names)])
    measures = item(PixelSpacing=list(map(repr, SPACING[[1, 0]].tolist())), SliceThickness="2.5")
    if between:
        measures.SpacingBetweenSlices = "2.5"
    one.SharedFunctionalGroupsSequence = Sequence([item(
        PixelMeasuresSequence=measures, PlaneOrientationSequence=item(
            ImageOrientationPatient=slices[0].ImageOrientationPatient))])
    one.PerFrameFunctionalGroupsSequence = Sequence()
    pixels = []
    for n, z, data in frames:
        group = item(PlanePositionSequence=item(
            ImagePositionPatient=slices[z].ImagePositionPatient))
        if n:
            group.SegmentIdentificationSequence = Sequence([item(ReferencedSegmentNumber=n)])
        one.PerFrameFunctionalGroupsSequence.append(group)
        pixels.append(data)
    pixels = numpy.stack(pixels)
    if bits == 1:
        packed = numpy.packbits(pixels.ravel().astype(bool), bitorder="little").tobytes()
    else:
        packed = pixels.astype("<u%d" % (bits // 8)).tobytes()
    one.PixelData = packed + b"\0" * (len(packed) % 2)
    one["PixelData"].VR = "OB" if bits < 16 else "OW"
    one.Rows, one.Columns = pixels.shape[1:]
    return one


def frames_of(labels, scale=1):
    """Of each segment those planes that have it, in no order."""
    frames = [(n, z, scale * (labels[:, :, z].T == n)) for n in range(1, labels.max() + 1)
              for z in range(labels.shape[2]) if (labels[:, :, z] == n).any()]
    random.Random(3).shuffle(frames)
    return frames


def make():
    slices = slices_of(voxels(), PLACE)
    os.mkdir("ct")
    for z, one in enumerate(slices):
        one.save_as("ct/IM%d" % (z * 5 % 14))
    x, y, z = numpy.indices(SIZE)
    labels = numpy.zeros(SIZE, numpy.uint8)
    labels[(x - 9) ** 2 + (y - 12) ** 2 + (2 * (z - 6)) ** 2 < 40] = 1
    labels[(x > 18) & (y < 5) & (z > 3) & (z < 9)] = 2
    labels[(x < 4) & (y == 20) & (z % 2 == 1)] = 3
    names = ["liver", "Nebenniere rechts \u00e4u\u00dferer Teil", 'spleen "left"']
    save_twin("labels", labels, PLACE)
    seg_of(slices, frames_of(labels), names).save_as("binary.dcm")
    seg_of(slices, frames_of(labels), names, between=False).save_as("unspaced.dcm")
    few = numpy.where((z == 3) | (z == 9), labels, 0)  # six slices apart
    save_twin("few", few, PLACE)
    seg_of(slices, frames_of(few), names, between=False).save_as("few.dcm")
    plain = pydicom.dcmread("binary.dcm")
    plain.is_implicit_VR = True
    plain.file_meta.TransferSyntaxUID = pydicom.uid.ImplicitVRLittleEndian
    plain.save_as("implicit.dcm")
    fractional = [(n, z, numpy.where(data, 120, 30)) for n, z, data in frames_of(labels)]
    seg_of(slices, fractional, names, 8, "FRACTIONAL").save_as("fractional.dcm")
    whole = [(None, z, labels[:, :, z].T) for z in range(SIZE[2])][::-1]
    seg_of(slices, whole, names, 16, "LABELMAP").save_as("labelmap.dcm")
    seg_of(slices, whole, names, 8, "LABELMAP").save_as("labelmap8.dcm")
    grown = [(n, z, data | ((x[:, :, 0].T < 10) & (n == 2) & (3 < z < 8)))
             for n, z, data in frames_of(labels)]
    seg_of(slices, grown, names).save_as("overlap.dcm")
    over = labels.copy()
    over[:10, :, 4:8] = numpy.where(over[:10, :, 4:8] == 3, 3, 2)
    save_twin("overlap", over, PLACE)
    save_twin("overlap-1", numpy.where(labels == 1, 1, 0).astype(numpy.uint8), PLACE)
    print(int((labels[:10, :, 4:8] % 2 == 1).sum()))

    # hostile and damaged
    whole = open("binary.dcm", "rb").read()
    write("bad-pixels.dcm", whole[:-20])
    write("cut-header.dcm", whole[:len(whole) // 2])
    hurt("many", lambda s: setattr(s, "NumberOfFrames", 10 ** 9))
    hurt("more", lambda s: setattr(s, "NumberOfFrames", s.NumberOfFrames + 1))
    hurt("large", lambda s: (setattr(s, "Rows", 65535), setattr(s, "Columns", 65535)))
    hurt("stray", lambda s: setattr(group_of(s).SegmentIdentificationSequence[0],
                                         "ReferencedSegmentNumber", 9))
    hurt("both", lambda s: (lambda q: q.append(q[0]))(group_of(s).SegmentIdentificationSequence))
    hurt("nowhere", lambda s: delattr(group_of(s), "PlanePositionSequence"))
    hurt("shifted", lambda s: move(s, [0.5, 0, 0]))
    hurt("between", lambda s: move(s, 0.4 * LPS[:3, :3] @ PLACE[:3, 2]))
    hurt("far", lambda s: move(s, 1e5 * LPS[:3, :3] @ PLACE[:3, 2]))
    hurt("endless", lambda s: move(s, [1e300, 0, 0]))
    hurt("coded", recode)
    hurt("shared", share)
    hurt("lacking", uncode)
    hurt("twice", lambda s: setattr(s.SegmentSequence[1], "SegmentNumber", 1))
    hurt("again", lambda s: group_of(s).update({"PlanePositionSequence": next(
        g.PlanePositionSequence for g in s.PerFrameFunctionalGroupsSequence if g != group_of(s) and
        g.SegmentIdentificationSequence == group_of(s).SegmentIdentificationSequence)}))
    hurt("padded", lambda s: setattr(s, "PixelData", s.PixelData + b"\0" * 10))
    hurt("none", lambda s: delattr(s, "SegmentSequence"))
    hurt("kind", lambda s: setattr(s, "SegmentationType", "OTHER"))
    hurt("other-grid", lambda s: setattr(
        s.SharedFunctionalGroupsSequence[0].PixelMeasuresSequence[0], "PixelSpacing", ["2", "2"]))


def group_of(seg):
    return seg.PerFrameFunctionalGroupsSequence[2]


def move(seg, by):
    place = group_of(seg).PlanePositionSequence[0]
    place.ImagePositionPatient = [
        pydicom.valuerep.DSfloat(float(a) + b, auto_format=True)
        for a, b in zip(place.ImagePositionPatient, by)]


def recode(seg):
    """A code with a modifier, one of another category, one that does not fit, in this order."""
    first, second, third = seg.SegmentSequence
    first.SegmentedPropertyTypeCodeSequence[0].SegmentedPropertyTypeModifierCodeSequence = \
        Sequence([code("7771000", "SCT", "Left")])
    second.SegmentedPropertyCategoryCodeSequence = Sequence([
        code("49755003", "SCT", "Morphologically Altered Structure")])
    second.SegmentedPropertyTypeCodeSequence = Sequence([code("M-01000", "SRT", "A|B & C")])
    third.SegmentedPropertyTypeCodeSequence = Sequence([code("1 2", "SCT", "Spleen")])


def share(seg):
    """Two segments in one plane, whose place all frames share."""
    groups = seg.PerFrameFunctionalGroupsSequence
    places = [g.PlanePositionSequence[0].ImagePositionPatient for g in groups]
    chosen = next([m for m, b in enumerate(places) if b == a] for n, a in enumerate(places)
                  if places.count(a) > 1)
    pixels = seg.pixel_array[chosen]
    seg.PixelData = numpy.packbits(pixels.ravel(), bitorder="little").tobytes()
    seg.NumberOfFrames = len(chosen)
    seg.PerFrameFunctionalGroupsSequence = [groups[n] for n in chosen]
    seg.SharedFunctionalGroupsSequence[0].PlanePositionSequence = \
        groups[chosen[0]].PlanePositionSequence
    for group in seg.PerFrameFunctionalGroupsSequence:
        del group.PlanePositionSequence


def uncode(seg):
    """A code without a value, one without a scheme, one with a colon in its value."""
    first, second, third = (s.SegmentedPropertyTypeCodeSequence[0] for s in seg.SegmentSequence)
    del first.CodeValue
    first.LongCodeValue = "http://example.org/liver/of/a/long/name"
    del second.CodingSchemeDesignator
    third.CodeValue = "10:2"


def hurt(name, change):
    one = pydicom.dcmread("binary.dcm")
    change(one)
    one.save_as("bad-%s.dcm" % name)


def read(path, of, series=None):
    image = nibabel.load(of)
    expected = numpy.asarray(image.dataobj)
    found = numpy.zeros_like(expected)
    to_voxel = numpy.linalg.inv(image.affine) @ LPS
    seg = pydicom.dcmread(path)
    numbers = {}
    for segment in seg.SegmentSequence:
        number = int(segment.get("SegmentDescription", "label %d" % segment.SegmentNumber)[6:])
        numbers[segment.SegmentNumber] = number
        print(number, segment.SegmentLabel, list(segment.RecommendedDisplayCIELabValue), *(
            word for kind in ("Category", "Type")
            for one in segment["SegmentedProperty%sCodeSequence" % kind]
            for word in (one.CodingSchemeDesignator, one.CodeValue, one.CodeMeaning)), sep="|")
    frames = seg.pixel_array.reshape(-1, seg.Rows, seg.Columns)
    shared = seg.SharedFunctionalGroupsSequence[0]
    axes = numpy.array(shared.PlaneOrientationSequence[0].ImageOrientationPatient, float)
    spacing = numpy.array(shared.PixelMeasuresSequence[0].PixelSpacing, float)
    slices = {}  # the places of each file
    for name in ([series] if os.path.isfile(series) else
                 [os.path.join(series, name) for name in os.listdir(series)]) if series else []:
        one = pydicom.dcmread(name)
        slices[one.SOPInstanceUID] = [group.PlanePositionSequence[0] for group in one.get(
            "PerFrameFunctionalGroupsSequence", [])] or [one]
    listed = seg.ReferencedSeriesSequence[0]
    if series:
        assert {one.ReferencedSOPInstanceUID for one in listed.ReferencedInstanceSequence} == \
            set(slices)
        assert listed.SeriesInstanceUID == one.SeriesInstanceUID
        for name in ("StudyInstanceUID", "FrameOfReferenceUID"):
            assert seg[name] == one[name], name
    for group, pixels in zip(seg.PerFrameFunctionalGroupsSequence, frames):
        at = numpy.array(group.PlanePositionSequence[0].ImagePositionPatient, float)
        source = [one for derived in group.get("DerivationImageSequence", [])
                  for one in derived.SourceImageSequence]
        assert len(source) == (1 if series else 0)
        for one in source:
            places = slices[one.ReferencedSOPInstanceUID]
            assert ("ReferencedFrameNumber" in one) == (len(places) > 1)
            first = numpy.array(places[one.get("ReferencedFrameNumber", 1) - 1]
                                .ImagePositionPatient, float)
            assert abs(numpy.dot(at - first, numpy.cross(axes[:3], axes[3:]))) < 1e-3, at - first
        y, x = numpy.nonzero(pixels)
        place = numpy.ones((4, len(x)))
        place[:3] = numpy.array(group.PlanePositionSequence[0].ImagePositionPatient,
                                float)[:, None] + \
            axes[:3, None] * spacing[1] * x + axes[3:, None] * spacing[0] * y
        at = (to_voxel @ place)[:3]
        assert numpy.abs(at - at.round()).max(initial=0) < 1e-3, at
        at = tuple(at.round().astype(int))
        assert (found[at] == 0).all(), "segments overlap"
        found[at] = numbers[group.SegmentIdentificationSequence[0].ReferencedSegmentNumber]
    assert (found == expected).all(), "%d voxels differ" % (found != expected).sum()


def corpus():
    """Segmentations of 8x6 pixels, without what no reader needs."""
    needed = {"SOPClassUID", "SOPInstanceUID", "SpecificCharacterSet", "SegmentationType", "Rows",
              "Columns", "BitsAllocated", "BitsStored", "HighBit", "PixelRepresentation",
              "SamplesPerPixel", "NumberOfFrames", "MaximumFractionalValue", "SegmentSequence",
              "SharedFunctionalGroupsSequence", "PerFrameFunctionalGroupsSequence", "PixelData"}
    os.makedirs("corpus")
    for name in ("binary", "implicit", "fractional", "labelmap", "labelmap8", "overlap",
                 "bad-coded", "bad-many", "bad-stray", "bad-far", "bad-endless"):
        one = pydicom.dcmread(name + ".dcm")
        frames = one.NumberOfFrames
        one.NumberOfFrames = len(one.PerFrameFunctionalGroupsSequence)
        pixels = one.pixel_array[:4, 4:10, 4:12]
        one.PerFrameFunctionalGroupsSequence = one.PerFrameFunctionalGroupsSequence[:4]
        one.Rows, one.Columns = pixels.shape[1:]
        one.NumberOfFrames = frames if frames > 1000 else len(pixels)
        one.PixelData = (numpy.packbits(pixels.ravel().astype(bool), bitorder="little")
                         if one.BitsAllocated == 1 else pixels).tobytes()
        for element in list(one):
            if element.keyword not in needed:
                del one[element.tag]
        one.save_as("corpus/" + name)


def damage(path):
    """Copies with a few wrong bytes before the pixels."""
    rest, whole = random.Random(5), open(path, "rb").read()
    for n in range(60):
        bytes_ = bytearray(whole)
        for _ in range(1 + n % 4):
            bytes_[rest.randrange(1000, whole.rindex(b"\xe0\x7f\x10\0"))] = rest.randrange(256)
        write("damaged-%d.dcm" % n, bytes_)


if sys.argv[1] == "damage":
    damage(sys.argv[2])
elif sys.argv[1] == "corpus":
    corpus()
elif sys.argv[1] == "read":
    read(*sys.argv[2:])
else:
    os.chdir(sys.argv[1])
    make()
