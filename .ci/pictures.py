"""Compares what the viewer shows with the pictures of the chapters, or with --pictures puts it in their place.

The bar of the viewer's menu is cut off, and a picture has half as many pixels in a row as the screen and at most 256
colours, so that a page stays light.
"""

import sys
from pathlib import Path

from PIL import Image, ImageChops, ImageStat

# Logical points of the bar above the views.
MENU = 26
# How far the mean of a channel may be off, of 255: another machine smooths its lines otherwise.
TOLERANCE = 2.0


def picture(screenshot: Path) -> Image.Image:
    screen = Image.open(screenshot).convert("RGB")
    scale = screen.width // 1100
    views = screen.crop((0, MENU * scale, screen.width, screen.height))
    small = views.resize((1100, 700 - MENU), Image.Resampling.LANCZOS)
    return small.quantize(256, dither=Image.Dither.NONE)


def difference(one: Image.Image, other: Image.Image) -> float:
    pair = [image.convert("RGB") for image in (one, other)]
    return max(ImageStat.Stat(ImageChops.difference(*pair)).mean)


def main() -> None:
    work, shown, *flags = sys.argv[1:]
    screenshots = sorted(Path(work).glob("*.png"))
    pictures = {path.stem for path in Path(shown).glob("*.png")}
    take = "--pictures" in flags
    wrong = []
    for screenshot in screenshots:
        made, kept = picture(screenshot), Path(shown) / screenshot.name
        if take:
            kept.parent.mkdir(exist_ok=True)
            made.save(kept, optimize=True)
            print(f"{kept}: {kept.stat().st_size // 1000} kB")
        elif screenshot.stem not in pictures:
            wrong.append(f"{kept} is missing")
        else:
            off = difference(made, Image.open(kept))
            print(f"{kept}: off by {off:.2f}")
            if off > TOLERANCE:
                wrong.append(f"{kept} is not what the viewer shows")
    if not take:
        names = {screenshot.stem for screenshot in screenshots}
        wrong += [f"{shown}/{name}.png has no scene" for name in sorted(pictures - names)]
    if wrong:
        sys.exit("\n".join(wrong) + "\nLook at it; if it is right, `.ci/recordings --pictures` takes the pictures again.")


if __name__ == "__main__":
    main()
