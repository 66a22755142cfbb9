"""Grasshopper archives: every type there and back, by bytes and by XML, and no damage that goes unseen."""

from __future__ import annotations

import struct
import uuid
import zlib
from decimal import Decimal

import pytest
from hypothesis import given
from hypothesis import settings
from hypothesis import strategies as st

from compas_cgc.errors import FileError
from compas_cgc.grasshopper.build.archive import TYPES
from compas_cgc.grasshopper.build.archive import Chunk
from compas_cgc.grasshopper.build.archive import chunk
from compas_cgc.grasshopper.build.archive import from_bytes
from compas_cgc.grasshopper.build.archive import from_xml
from compas_cgc.grasshopper.build.archive import item
from compas_cgc.grasshopper.build.archive import read_archive
from compas_cgc.grasshopper.build.archive import to_bytes
from compas_cgc.grasshopper.build.archive import to_xml
from compas_cgc.grasshopper.build.archive import write_archive

# The worked example of the format: inflated bytes, and a file that Grasshopper could have written.
PLAIN = bytes.fromhex(
    "0a 55 73 65 72 4f 62 6a 65 63 74 ff ff ff ff 01 00 00 00 01 00 00 00"
    "01 41 ff ff ff ff 03 00 00 00 05 00 00 00"
    "01 4b 00 00 00 00 01 00 00 00 00 00 00 00"
    "01 62 ff ff ff ff 01 00 00 00 01"
)
FILE = bytes.fromhex(
    "e3 0a 2d 4e 2d f2 4f ca 4a 4d 2e f9 0f 04 8c 0c 0c 0c 60 ec 08 e2 31 03 59 ac 20 9e 37 03 54 1c 4c 27 c1 55 02 00".replace(" ", "")
)
WORKED = chunk("UserObject", [item("A", "gh_int32", 5)], [chunk("K", [item("b", "gh_bool", True)], index=0)])


def inflated(data):
    return zlib.decompress(data, -15)


def deflated(data):
    deflate = zlib.compressobj(9, zlib.DEFLATED, -15)
    return deflate.compress(data) + deflate.flush()


def test_the_worked_example_byte_by_byte():
    assert from_bytes(FILE) == WORKED
    assert inflated(to_bytes(WORKED)) == PLAIN
    guid = uuid.UUID("410755b1-224a-4c1e-a407-bf32fb45ea7e")
    assert bytes.fromhex("b15507414a221e4ca407bf32fb45ea7e") in inflated(to_bytes(chunk("r", [item("g", "gh_guid", guid)])))
    amount = item("d", "gh_decimal", Decimal("123.456"))
    assert inflated(to_bytes(chunk("r", [amount]))).endswith(bytes.fromhex("40e20100000000000000000000000300"))
    colour = item("c", "gh_drawing_color", (255, 1, 2, 3))
    assert inflated(to_bytes(chunk("r", [colour]))).endswith(bytes.fromhex("030201ff")), "little-endian 0xAARRGGBB"


# ----------------------------------------------------------------------
# There and back
# ----------------------------------------------------------------------

XML_TEXT = st.text(st.characters(blacklist_categories=("Cs", "Cc", "Cn"), blacklist_characters="\ufffe\uffff")) | st.sampled_from(
    ["a\nb", "a\r\nb\r", "<&>\"'", "é 日本 K̄", "\ttab"]
)
WHOLE = {"<B": st.integers(0, 255), "<i": st.integers(-(2**31), 2**31 - 1), "<q": st.integers(-(2**63), 2**63 - 1)}
FINITE = st.floats(allow_nan=False)
SINGLE = st.floats(width=32, allow_nan=False)
BY_NAME = {
    "gh_bool": st.booleans(),
    "gh_single": SINGLE,
    "gh_double": FINITE,
    "gh_decimal": st.decimals(-(10**18), 10**18, places=6),
    "gh_guid": st.uuids(),
    "gh_string": XML_TEXT,
    "gh_bytearray": st.binary(),
    "gh_drawing_bitmap": st.binary(),
    "gh_doublearray": st.lists(FINITE, max_size=5),
    "gh_drawing_color": st.tuples(*[st.integers(0, 255)] * 4),
}


def values_of(kind):
    if kind.name in BY_NAME:
        return BY_NAME[kind.name]
    if not kind.fields:
        return WHOLE[kind.format]
    number = {"i": WHOLE["<i"], "f": SINGLE, "d": FINITE}[kind.format[-1]]
    return st.tuples(*[number] * len(kind.fields))


INDEX = st.none() | st.integers(0, 300)
NAME = st.text(st.characters(blacklist_categories=("Cs", "Cc", "Cn"), blacklist_characters="\ufffe\uffff"), min_size=1, max_size=200)
ITEMS = st.lists(
    st.sampled_from(sorted(TYPES)).flatmap(lambda name: st.tuples(NAME, INDEX, st.just(name), values_of(TYPES[name]))),
    max_size=4,
    unique_by=lambda row: row[:2],
).map(lambda rows: [item(name, kind, value, index) for name, index, kind, value in rows])
LEAF = st.builds(chunk, NAME, ITEMS, st.just(()), INDEX)
TREE = st.recursive(
    LEAF,
    lambda parts: st.builds(chunk, NAME, ITEMS, st.lists(parts, max_size=3, unique_by=lambda c: (c.name, c.index)), INDEX),
    max_leaves=6,
)


@given(TREE)
@settings(max_examples=150)
def test_every_tree_comes_back_item_by_item(tree):
    data = to_bytes(tree)
    assert from_bytes(data) == tree
    assert to_bytes(from_bytes(data)) == data
    root = chunk(tree.name, tree.items, tree.chunks)  # the root of an XML file has no index
    assert from_xml(to_xml(root)) == root


@pytest.mark.parametrize("name", sorted(TYPES))
def test_every_type_survives_a_change_of_form(name):
    @given(values_of(TYPES[name]))
    @settings(max_examples=30)
    def check(value):
        root = chunk("Root", [item("v", name, value, 3)])
        there = from_xml(to_xml(from_bytes(to_bytes(root))))
        assert there == root and type(there.get("v", 3)) is type(root.get("v", 3))

    check()


def test_files_by_suffix(tmp_path):
    for suffix in ("gh", "ghx", "ghuser"):
        write_archive(tmp_path / f"a.{suffix}", WORKED)
        assert read_archive(tmp_path / f"a.{suffix}") == WORKED
    assert (tmp_path / "a.gh").read_bytes() != (tmp_path / "a.ghx").read_bytes()
    with pytest.raises(FileError, match=r"a\.3dm: the suffix of a Grasshopper file must be one of \.gh"):
        read_archive(tmp_path / "a.3dm")
    with pytest.raises(FileError, match=r"none\.gh"):
        read_archive(tmp_path / "none.gh")


def test_items_are_sorted_and_chunks_are_not():
    names = [("b", None), ("Z", None), ("b", 10), ("b", 2), ("a", None)]
    made = chunk("r", [item(name, "gh_int32", 0, index) for name, index in names], [chunk("z"), chunk("a")])
    assert [(i.name, i.index) for i in made.items] == [("Z", None), ("a", None), ("b", None), ("b", 2), ("b", 10)]
    assert [c.name for c in made.chunks] == ["z", "a"]


def test_values_are_found_by_name():
    assert WORKED.get("A") == 5 and WORKED.get("B", default=7) == 7 and WORKED.has("A") and not WORKED.has("A", 0)
    assert WORKED.child("K", 0).get("b") is True and WORKED.child("K") is None
    assert WORKED.children("K") == [WORKED.child("K", 0)]


def test_real_files_carry_comments_and_a_mark_and_no_counts():
    text = (
        b"\xef\xbb\xbf<?xml version='1.0' encoding='utf-8'?><!-- made by Grasshopper --><Archive name='Root'><items>"
        b"<item name='p' type_code='31'><X>0.1</X><Y>-2</Y></item></items></Archive>"
    )
    root = from_xml(text)
    assert root.get("p") == pytest.approx((0.1, -2.0), abs=1e-7) and b"<X>0.1</X><Y>-2</Y>" in to_xml(root)


# ----------------------------------------------------------------------
# What is refused
# ----------------------------------------------------------------------


@pytest.mark.parametrize(
    "name, kind, value",
    [
        ("a", "gh_int32", 2**31),
        ("a", "gh_int32", True),
        ("a", "gh_int32", 1.5),
        ("a", "gh_byte", -1),
        ("a", "gh_bool", 2),
        ("a", "gh_string", None),
        ("a", "gh_guid", "nonsense"),
        ("a", "gh_drawing_color", (0, 0, 300, 0)),
        ("a", "gh_point3d", (1, 2)),
        ("a", "gh_decimal", "NaN"),
        ("a", "gh_double", "much"),
        ("a", "gh_curve", 1),
    ],
)
def test_a_value_that_does_not_fit_its_type_is_refused(name, kind, value):
    with pytest.raises(FileError):
        item(name, kind, value)


def test_names_are_unique():
    with pytest.raises(FileError, match="the chunk 'r' holds 'a 1' twice"):
        chunk("r", [item("a", "gh_int32", 1, 1), item("a", "gh_bool", True, 1)])
    with pytest.raises(FileError, match="the chunk 'r' holds 'c' twice"):
        chunk("r", [], [chunk("c"), chunk("c")])


def everything() -> Chunk:
    items = [item(f"v{i}", name, SAMPLES[name]) for i, name in enumerate(TYPES)]
    return chunk("Root", items, [WORKED, chunk("Object", items, index=1)])


SAMPLES = {
    name: {"gh_bool": True, "gh_decimal": Decimal("1.5"), "gh_guid": uuid.UUID(int=5), "gh_string": "text"}.get(
        name,
        (1,) * len(kind.fields) if kind.fields else {"gh_drawing_color": (1, 2, 3, 4), "gh_doublearray": (1.0, 2.0)}.get(name, 5),
    )
    if name not in ("gh_bytearray", "gh_drawing_bitmap")
    else b"\x01\x02\x03"
    for name, kind in TYPES.items()
}


def test_a_file_cut_anywhere_is_refused():
    root = everything()
    assert from_bytes(to_bytes(root)) == root
    data, plain, text = to_bytes(root), inflated(to_bytes(root)), to_xml(root)
    for end in range(len(data)):
        with pytest.raises(FileError):
            from_bytes(data[:end])
    for end in range(len(plain)):
        with pytest.raises(FileError):
            from_bytes(deflated(plain[:end]))
    for end in range(0, len(text) - 2, 7):
        with pytest.raises(FileError):
            from_xml(text[:end])


@given(st.binary(max_size=300))
def test_noise_is_refused_or_read_but_never_breaks_the_reader(noise):
    for data in (noise, deflated(noise), deflated(PLAIN[:20] + noise), deflated(PLAIN + noise)):
        try:
            assert isinstance(from_bytes(data), Chunk)
        except FileError:
            pass
    try:
        from_xml(noise)
    except FileError:
        pass


@given(st.integers(0, len(PLAIN) - 1), st.integers(0, 255))
def test_a_changed_byte_is_refused_or_read_but_never_breaks_the_reader(at, byte):
    changed = bytearray(PLAIN)
    changed[at] = byte
    try:
        from_bytes(deflated(bytes(changed)))
    except FileError:
        pass


@pytest.mark.parametrize(
    "text",
    [
        b"<Fragment name='x'/>",
        b"<!DOCTYPE a [<!ENTITY b 'c'>]><Archive name='Root'/>",
        b"<Archive name='r'><items><item name='a' type_code='99'>1</item></items></Archive>",
        b"<Archive name='r'><items><item name='a'>1</item></items></Archive>",
        b"<Archive name='r'><items><item name='a' type_code='3'>x</item></items></Archive>",
        b"<Archive name='r'><items><item name='a' index='x' type_code='3'>1</item></items></Archive>",
        b"<Archive name='r'><items><item name='a' type_code='20'><stream>***</stream></item></items></Archive>",
        b"<Archive name='r'><items><item name='a' type_code='50'><X>1</X></item></items></Archive>",
        b"<Archive name='r'>" + b"<chunks><chunk name='c'>" * 200 + b"</chunk></chunks>" * 200 + b"</Archive>",
    ],
)
def test_xml_that_is_no_archive_is_refused(text):
    with pytest.raises(FileError):
        from_xml(text)


def test_huge_counts_and_deep_nests_cost_nothing():
    head = b"\x01r\xff\xff\xff\xff"
    for counts in (b"\xff\xff\xff\x7f\0\0\0\0", b"\0\0\0\0\xff\xff\xff\x7f", b"\xff\xff\xff\xff\0\0\0\0"):
        with pytest.raises(FileError):
            from_bytes(deflated(head + counts))
    deep = (head + b"\0\0\0\0\x01\0\0\0") * 500
    with pytest.raises(FileError, match="too deeply"):
        from_bytes(deflated(deep + head + b"\0" * 8))
    with pytest.raises(FileError, match="control character"):
        to_xml(chunk("r", [item("a", "gh_string", "\x1b")]))


@pytest.mark.parametrize("value", [3.4025001647762064e38, 3.4028234663852886e38, -3.4028234663852886e38, 1e-45])
def test_singles_at_the_end_of_their_range_go_through_xml(value):
    (value,) = struct.unpack("<f", struct.pack("<f", value))
    root = chunk("a", [item("b", "gh_single", value)], ())
    assert from_xml(to_xml(root)) == root
