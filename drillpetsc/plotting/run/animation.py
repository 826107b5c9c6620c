"""Animations: one picture per time into a GIF, or a film if imageio is installed."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.plotting.run.shape import Shape


def check_suffix(path: Path) -> None:
    """Raise ValueError, before anything is drawn, for a film that cannot be written."""
    if path.suffix.lower() != ".gif" and importlib.util.find_spec("imageio") is None:
        raise ValueError(
            f"{path.name}: only .gif can be written here; a film (.mp4) needs imageio with ffmpeg"
        )


def write_animation(
    drawing: Any, draw: Callable[[Shape], None], shapes: list[Shape], path: Path, rate: float, colormap: Any
) -> None:
    """Write one picture per shape into a GIF (pillow) or, for another suffix, a film (imageio).

    drawing: the figure; draw: draws one time into it. rate: pictures a second. colormap: of the field.
    """
    images = []
    for shape in shapes:
        draw(shape)
        drawing.canvas.draw()
        images.append(np.asarray(drawing.canvas.buffer_rgba())[..., :3].copy())
    if path.suffix.lower() == ".gif":
        from PIL import Image

        palette = _palette(images, colormap)
        pages = [
            Image.fromarray(image).quantize(255, palette=palette, dither=Image.Dither.NONE)
            for image in images
        ]
        pages[0].save(
            path, save_all=True, append_images=pages[1:], duration=round(1000 / rate), loop=0, disposal=1
        )
        return
    import imageio.v3 as imageio

    imageio.imwrite(
        path, [image[: image.shape[0] // 2 * 2, : image.shape[1] // 2 * 2] for image in images], fps=rate
    )


def _palette(images: list[np.ndarray], colormap: Any) -> Any:
    """Palette image of 255 colours: 96 of the field's colormap, for a few thin lines, and 159 for the rest.

    The latter are chosen from an image in which each colour occurs once; otherwise the wide background would
    get all of them.
    """
    from PIL import Image

    seen = np.zeros(0, dtype=np.int32)
    for image in images[:: max(len(images) // 8, 1)]:
        coarse = (
            image[::2, ::2].reshape(-1, 3).astype(np.int32) & 0xFC
        )  # steps of four: invisible, and fewer colours
        seen = np.union1d(seen, coarse[:, 0] << 16 | coarse[:, 1] << 8 | coarse[:, 2])
    once = np.stack((seen >> 16 & 255, seen >> 8 & 255, seen & 255), axis=-1).astype(np.uint8)[None]
    colours = Image.fromarray(once).quantize(158).getpalette() or []
    others = np.array(colours[: 3 * 158], dtype=np.uint8)
    own = (255 * colormap(np.linspace(0, 1, 96))[:, :3]).round().astype(np.uint8)
    palette = Image.new("P", (1, 1))
    palette.putpalette(np.concatenate((others, own.ravel(), np.full(3, 255, dtype=np.uint8))).tolist())
    return palette
