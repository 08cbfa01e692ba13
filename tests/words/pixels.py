# SPDX-License-Identifier: Apache-2.0
"""Small pictures of every kind, written by hand: PNG of each depth and colour type, Radiance, OpenEXR with any
channels; and our own OpenEXR read back. Standard library alone."""
import struct
import zlib

PNG_TYPES = {1: 0, 2: 4, 3: 2, 4: 6}  # by channels: grey, grey and alpha, colour, colour and alpha


def png(rows, bits=8, palette=None, transparent=None, gamma=None):
    """`rows`: lists of tuples of whole numbers; with a palette, of its indices. Stored, not deflated, so that every
    zlib writes the same bytes."""
    width, height, channels = len(rows[0]), len(rows), len(rows[0][0])

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    def packed(row):
        values = [v for pixel in row for v in pixel]
        if bits == 16:
            return struct.pack(f">{len(values)}H", *values)
        if bits == 8:
            return bytes(values)
        whole = "".join(format(v, f"0{bits}b") for v in values)
        whole += "0" * (-len(whole) % 8)
        return bytes(int(whole[i:i + 8], 2) for i in range(0, len(whole), 8))

    out = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, 3 if palette else
                                                           PNG_TYPES[channels], 0, 0, 0))
    if gamma:
        out += chunk(b"gAMA", struct.pack(">I", round(100000 * gamma)))
    if palette:
        out += chunk(b"PLTE", bytes(v for colour in palette for v in colour))
    if transparent:
        out += chunk(b"tRNS", transparent)
    return out + chunk(b"IDAT", zlib.compress(b"".join(b"\0" + packed(r) for r in rows), 0)) + chunk(b"IEND", b"")


def hdr(rows, header=(), form="32-bit_rle_rgbe"):
    """`rows`: of four bytes per pixel."""
    lines = ["#?RADIANCE", *header, f"FORMAT={form}", "", f"-Y {len(rows)} +X {len(rows[0])}", ""]
    return "\n".join(lines).encode() + bytes(v for row in rows for pixel in row for v in pixel)


TYPES = {"uint": (0, "I"), "half": (1, "e"), "float": (2, "f")}


def exr(rows, channels, kind="float", chromaticities=None, window=(0, 0)):
    """Uncompressed. `rows`: tuples of a pixel's values in the order of `channels`; the file's is the alphabet's."""
    width, height = len(rows[0]), len(rows)
    kinds = dict(zip(channels, [kind] * len(channels) if isinstance(kind, str) else kind))
    order = sorted(channels)

    def attribute(name, form, data):
        return name.encode() + b"\0" + form.encode() + b"\0" + struct.pack("<i", len(data)) + data

    listed = b"".join(c.encode() + b"\0" + struct.pack("<iB3xii", TYPES[kinds[c]][0], 0, 1, 1) for c in order) + b"\0"
    x0, y0 = window
    box = struct.pack("<4i", x0, y0, x0 + width - 1, y0 + height - 1)
    head = struct.pack("<ii", 20000630, 2) + attribute("channels", "chlist", listed)
    if chromaticities:
        head += attribute("chromaticities", "chromaticities", struct.pack("<8f", *chromaticities))
    head += (attribute("compression", "compression", b"\0") + attribute("dataWindow", "box2i", box)
             + attribute("displayWindow", "box2i", box) + attribute("lineOrder", "lineOrder", b"\0")
             + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
             + attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
             + attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + b"\0")
    lines = []
    for y, row in enumerate(rows):
        data = b"".join(struct.pack(f"<{width}{TYPES[kinds[c]][1]}", *(p[channels.index(c)] for p in row)) for c in order)
        lines.append(struct.pack("<ii", y0 + y, len(data)) + data)
    table, at = b"", len(head) + 8 * height
    for line in lines:
        table += struct.pack("<Q", at)
        at += len(line)
    return head + table + b"".join(lines)


def read_exr(data):
    """What the program writes, floats in ZIP blocks of 16 rows: {channel: rows}."""
    at = 8

    def word():
        nonlocal at
        end = data.index(b"\0", at)
        found, at = data[at:end].decode(), end + 1
        return found

    names, box = [], None
    while data[at]:
        name, _ = word(), word()
        size = struct.unpack_from("<i", data, at)[0]
        value = data[at + 4:at + 4 + size]
        at += 4 + size
        if name == "channels":
            inside = 0
            while value[inside]:
                end = value.index(b"\0", inside)
                names.append(value[inside:end].decode())
                inside = end + 17
        elif name == "dataWindow":
            box = struct.unpack("<4i", value)
    at += 1
    width, height = box[2] + 1, box[3] + 1
    found = {name: [None] * height for name in names}
    at += 8 * ((height + 15) // 16)
    for begin in range(0, height, 16):
        size = struct.unpack_from("<i", data, at + 4)[0]
        block, rows = data[at + 8:at + 8 + size], min(16, height - begin)
        at += 8 + size
        if size < 4 * width * len(names) * rows:
            block = unpredicted(zlib.decompress(block))
        for y in range(rows):
            for c, name in enumerate(names):
                found[name][begin + y] = struct.unpack_from(f"<{width}f", block, 4 * width * (y * len(names) + c))
    return found


def unpredicted(data):
    values, last = bytearray(data), data[0]
    for i in range(1, len(values)):
        last = values[i] = (last + values[i] - 128) & 255
    half = (len(values) + 1) // 2
    whole = bytearray(len(values))
    whole[0::2], whole[1::2] = values[:half], values[half:]
    return bytes(whole)


def bmp(rows, bits=24, palette=None, from_top=False):
    """`rows` as for png: of three or four values, or of indices of a palette of 256 colours."""
    width, height = len(rows[0]), len(rows)
    body = b""
    for row in rows if from_top else rows[::-1]:
        line = b"".join(bytes([p[2], p[1], p[0], *p[3:]]) if bits > 8 else bytes(p) for p in row)
        body += line + bytes(-len(line) % 4)
    table = b"".join(bytes([b, g, r, 0]) for r, g, b in palette or [])
    start = 54 + len(table)
    return (b"BM" + struct.pack("<IIIIiiHHIIiiII", start + len(body), 0, start, 40, width, -height if from_top else height, 1,
                                bits, 0, len(body), 0, 0, len(table) // 4, 0) + table + body)


def tga(rows, coded=False, from_top=False):
    """`rows` of one, three or four values a pixel; with the end of the second version, by which Mitsuba knows it."""
    channels = len(rows[0][0])
    kind = (3 if channels == 1 else 2) + (8 if coded else 0)
    pixels = [bytes(p) if channels == 1 else bytes([p[2], p[1], p[0], *p[3:]]) for row in (rows if from_top else rows[::-1])
              for p in row]
    if coded:
        pixels = [bytes([0x81]) + a if a == b else bytes([1]) + a + b for a, b in zip(pixels[::2], pixels[1::2])]
    return struct.pack("<BBBHHBHHHHBB", 0, 0, kind, 0, 0, 0, 0, 0, len(rows[0]), len(rows), 8 * channels,
                       0x20 if from_top else 0) + b"".join(pixels) + bytes(8) + b"TRUEVISION-XFILE.\0"


def jpeg(rows):
    """Blocks of 8 x 8 pixels, each of one colour: `rows` of one or three values a block, Y or Y, Cb, Cr. No coefficient
    but the first is needed, so that the tables are ours: differences by twelve codes of four bits, and one for the
    end."""
    height, width, n = len(rows), len(rows[0]), len(rows[0][0])

    def part(marker, data):
        return bytes([0xff, marker]) + struct.pack(">H", len(data) + 2) + data

    bits, last = "", [0] * n
    for row in rows:
        for block in row:
            for c, v in enumerate(block):  # the first coefficient is 8 times the mean; it is divided by 8
                difference, last[c] = v - 128 - last[c], v - 128
                size = abs(difference).bit_length()
                low = difference if difference >= 0 else difference + (1 << size) - 1
                bits += f"{size:04b}" + (f"{low:0{size}b}" if size else "") + "0"
    bits += "1" * (-len(bits) % 8)
    body = bytes(int(bits[i:i + 8], 2) for i in range(0, len(bits), 8)).replace(b"\xff", b"\xff\0")
    listed = range(1, n + 1)
    return (b"\xff\xd8" + part(0xdb, bytes([0]) + bytes([8] * 64))
            + part(0xc0, struct.pack(">BHHB", 8, 8 * height, 8 * width, n) + b"".join(bytes([c, 0x11, 0]) for c in listed))
            + part(0xc4, bytes([0x00, 0, 0, 0, 12] + [0] * 12) + bytes(range(12)))
            + part(0xc4, bytes([0x10, 1] + [0] * 15) + b"\0")
            + part(0xda, bytes([n]) + b"".join(bytes([c, 0]) for c in listed) + bytes([0, 63, 0])) + body + b"\xff\xd9")
