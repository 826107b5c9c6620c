"""Compile the kernels with the package: into the wheel, or beside the sources of an editable install."""

import importlib.util
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py
from setuptools.dist import Distribution

KERNELS = Path("drillpetsc") / "kernels"


class BuildWithKernels(build_py):
    """The Python files, then the library of the kernels."""

    def run(self) -> None:
        super().run()
        # from its file: importing the package would need what is not installed yet
        spec = importlib.util.spec_from_file_location(
            "kernels_build", Path(__file__).parent / KERNELS / "build.py"
        )
        builder = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(builder)
        if self.editable_mode:
            builder.build()
        else:
            objects = Path(self.get_finalized_command("build").build_temp).resolve() / "kernels"
            builder.build(Path(self.build_lib).resolve() / KERNELS / "_build", objects)


class CompiledDistribution(Distribution):
    """A wheel for this machine only."""

    def has_ext_modules(self) -> bool:
        return True


setup(cmdclass={"build_py": BuildWithKernels}, distclass=CompiledDistribution)
