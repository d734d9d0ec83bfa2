"""Ways in which disks and copies spoil any file; each takes its bytes and a generator."""


def flip_bits(data, rng):
    """Flip one to twenty bits anywhere."""
    spoiled = bytearray(data)
    for place in rng.integers(len(data), size=int(rng.integers(1, 21))):
        spoiled[place] ^= 1 << int(rng.integers(8))
    return bytes(spoiled)


def truncate(data, rng):
    """Keep the beginning."""
    return data[: int(rng.integers(len(data)))]


def zero_block(data, rng):
    """Lose a block to zeros, as a disk does."""
    first, length = int(rng.integers(len(data))), int(2 ** rng.uniform(0, 13))
    return data[:first] + bytes(len(data[first : first + length])) + data[first + length :]


def overwrite_block(data, rng):
    """Lose a block to garbage."""
    first, length = int(rng.integers(len(data))), int(2 ** rng.uniform(0, 13))
    garbage = rng.bytes(len(data[first : first + length]))
    return data[:first] + garbage + data[first + length :]


def drop_block(data, rng):
    """Lose a block from the middle, and move up what follows."""
    first, length = int(rng.integers(len(data))), int(2 ** rng.uniform(0, 13))
    return data[:first] + data[first + length :]


def append_garbage(data, rng):
    """Gain bytes at the end."""
    return data + rng.bytes(int(rng.integers(1, 4096)))


DAMAGES = (flip_bits, truncate, zero_block, overwrite_block, drop_block, append_garbage)


def spoil_file(source, target, rng):
    """Copy a file and damage it once; the name of what was done."""
    damage = DAMAGES[int(rng.integers(len(DAMAGES)))]
    target.write_bytes(damage(source.read_bytes(), rng))
    return damage.__name__
