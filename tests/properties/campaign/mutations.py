"""Ways in which people, disks and editors spoil a campaign folder; each takes (folder, rng)."""

import re
import shutil

import numpy as np

GARBAGE = ("", "nan", "inf", "-1e308", "1e999", "0x10", "twelve", "1,5", "é", "\x00", "=1+1", "'")


def pick(items, rng):
    items = sorted(items)
    return items[int(rng.integers(len(items)))]


def pick_file(folder, rng, pattern="**/*"):
    return pick([path for path in folder.glob(pattern) if path.is_file()], rng)


def edit_cell(path, rng, change):
    rows = [line.split(",") for line in path.read_text().splitlines()]
    row = int(rng.integers(1, len(rows)))
    column = int(rng.integers(len(rows[row])))
    rows[row][column] = change(rows[row][column])
    path.write_text("\n".join(",".join(cells) for cells in rows) + "\n")


def flip_bits(folder, rng):
    path = pick_file(folder, rng)
    data = bytearray(path.read_bytes())
    for place in rng.integers(len(data), size=int(rng.integers(1, 20))):
        data[place] ^= 1 << int(rng.integers(8))
    path.write_bytes(bytes(data))


def truncate(folder, rng):
    path = pick_file(folder, rng)
    path.write_bytes(path.read_bytes()[: int(rng.integers(path.stat().st_size))])


def remove(folder, rng):
    pick_file(folder, rng).unlink()


def replace_by_folder(folder, rng):
    path = pick_file(folder, rng)
    path.unlink()
    path.mkdir()


def insert_not_text(folder, rng):
    path = pick_file(folder, rng)
    data = path.read_bytes()
    place = int(rng.integers(len(data) + 1))
    path.write_bytes(data[:place] + b"\xff\xfe\x80" + data[place:])


def spoil_cell(folder, rng):
    word = GARBAGE[int(rng.integers(len(GARBAGE)))]
    edit_cell(pick_file(folder, rng, "**/*.csv"), rng, lambda _: word)


def scale_column(folder, rng):
    """Degrees for radians, millimetres for metres, milliseconds for seconds."""
    path = pick_file(folder, rng, "**/*.csv")
    rows = [line.split(",") for line in path.read_text().splitlines()]
    column = int(rng.integers(len(rows[0])))
    factor = float(rng.choice([180 / np.pi, 1e3, 1e-3, -1.0, 1e9]))
    for row in rows[1:]:
        try:
            row[column] = repr(float(row[column]) * factor)
        except (ValueError, IndexError):
            continue
    path.write_text("\n".join(",".join(row) for row in rows) + "\n")


def flood_with_nan(folder, rng):
    path = pick_file(folder, rng, "**/*.csv")
    head, *rows = path.read_text().splitlines()
    share = rng.uniform(0.2, 1.0)
    kept = [re.sub(r"[^,]+$", "nan", row) if rng.random() < share else row for row in rows]
    path.write_text("\n".join([head, *kept]) + "\n")


def rename_column(folder, rng):
    path = pick_file(folder, rng, "**/*.csv")
    head, *rows = path.read_text().splitlines()
    names = head.split(",")
    names[int(rng.integers(len(names)))] = str(rng.choice(["q9_rad", "time", "", "trial", "x"]))
    path.write_text("\n".join([",".join(names), *rows]) + "\n")


def shuffle_rows(folder, rng):
    path = pick_file(folder, rng, "**/*.csv")
    head, *rows = path.read_text().splitlines()
    path.write_text("\n".join([head, *rng.permutation(rows).tolist()]) + "\n")


def repeat_rows(folder, rng):
    path = pick_file(folder, rng, "**/*.csv")
    head, *rows = path.read_text().splitlines()
    path.write_text("\n".join([head, *rows, *rows[: int(rng.integers(1, 4))]]) + "\n")


def ragged_row(folder, rng):
    path = pick_file(folder, rng, "**/*.csv")
    with path.open("a") as file:
        file.write("1,2,3,4,5,6,7,8,9\n")


def exchange_files(folder, rng):
    one, two = pick_file(folder, rng), pick_file(folder, rng)
    a, b = one.read_bytes(), two.read_bytes()
    one.write_bytes(b)
    two.write_bytes(a)


def lead_out(folder, rng):
    path = folder / "trials.csv"
    target = str(rng.choice(["../../secret.csv", "/etc/hostname", "..", ".", "angles"]))
    path.write_text(re.sub(r"angles/\w+\.csv", target, path.read_text(), count=1))


def change_key(folder, rng):
    path = folder / "campaign.yaml"
    words = re.findall(r"\b\w+(?=:)", path.read_text())
    word = pick(set(words), rng)
    other = str(
        rng.choice(["frobnicate", word + "s", "version", "<<", "!!python/object:os.system"])
    )
    path.write_text(path.read_text().replace(f"{word}:", f"{other}:", 1))


def change_value(folder, rng):
    path = folder / "campaign.yaml"
    values = ["-1", "0", "1e30", ".nan", ".inf", "[]", "{}", "null", "yes", "25", "'x'", "[[1]]"]
    lines = path.read_text().splitlines()
    place = int(rng.integers(len(lines)))
    lines[place] = re.sub(r":.*$", f": {rng.choice(values)}", lines[place])
    path.write_text("\n".join(lines) + "\n")


def set_a_yaml_bomb(folder, rng):
    del rng
    layers = ["a0: &a0 [lol, lol, lol, lol, lol, lol, lol, lol, lol, lol]"]
    layers += [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 10)}]" for k in range(1, 10)]
    with (folder / "campaign.yaml").open("a") as file:
        file.write("\n".join(layers) + "\n")


def nest_deeply(folder, rng):
    depth = int(rng.integers(50, 3000))
    with (folder / "campaign.yaml").open("a") as file:
        file.write("deep: " + "[" * depth + "]" * depth + "\n")


def make_huge(folder, rng):
    path = pick_file(folder, rng)
    with path.open("a") as file:
        file.write("0," * 600_000)


def duplicate_trial(folder, rng):
    path = folder / "trials.csv"
    rows = path.read_text().splitlines()
    path.write_text("\n".join([*rows, rows[int(rng.integers(1, len(rows)))]]) + "\n")


def link_in_a_circle(folder, rng):
    path = pick_file(folder, rng)
    path.unlink()
    path.symlink_to(path.name)


def change_line_ends(folder, rng):
    path = pick_file(folder, rng)
    ends = (b"\r\n", b"\r", b"\n\n", b"\0")[int(rng.integers(4))]
    path.write_bytes(path.read_bytes().replace(b"\n", ends))


def spoil_nothing(folder, rng):
    """A control: the campaign stays whole."""


MUTATIONS = (
    flip_bits, truncate, remove, replace_by_folder, insert_not_text, spoil_cell, scale_column,
    flood_with_nan, rename_column, shuffle_rows, repeat_rows, ragged_row, exchange_files, lead_out,
    change_key, change_value, set_a_yaml_bomb, nest_deeply, make_huge, duplicate_trial,
    link_in_a_circle, change_line_ends, spoil_nothing,
)  # fmt: skip


def spoil(source, target, rng):
    """Copy a campaign and spoil it once or twice; the names of what was done."""
    shutil.copytree(source, target)
    done = []
    for _ in range(int(rng.integers(1, 3))):
        mutation = MUTATIONS[int(rng.integers(len(MUTATIONS)))]
        try:
            mutation(target, rng)
        except (OSError, ValueError, UnicodeDecodeError, IndexError):
            continue  # what the first spoiled, the second may not be able to read
        done.append(mutation.__name__)
    return done
