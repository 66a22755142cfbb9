"""Build step that adds the components to the wheel as ``compas_cgc/ghuser``; referenced in pyproject.toml."""

from __future__ import annotations

from pathlib import Path

from setuptools.command.build_py import build_py

__all__ = ["BuildWithComponents"]

WANTED = ("icon.png", "components/*/code.py", "components/*/icon.png", "components/*/metadata.json")


class BuildWithComponents(build_py):
    """The build of the package, with the components as a part of its data."""

    def get_source_files(self) -> list[str]:
        """Return the files of the sdist: with the components, and what makes and packs them."""
        return [*super().get_source_files(), *_paths(*WANTED, "*.py")]

    def get_output_mapping(self) -> dict[str, str]:
        """Return the sources of the files that are built, by the files."""
        return {**super().get_output_mapping(), **self._components()}

    def run(self) -> None:
        """Copy the components; an editable install reads them from the source folder."""
        super().run()
        if not self.editable_mode:
            for target, source in self._components().items():
                self.mkpath(str(Path(target).parent))
                self.copy_file(source, target, preserve_mode=False)

    def _components(self) -> dict[str, str]:
        return {str(Path(self.build_lib, "compas_cgc", path)): path for path in _paths(*WANTED)}


def _paths(*patterns: str) -> list[str]:
    # Setuptools builds in the folder of pyproject.toml, and wants paths from there.
    return [path.as_posix() for pattern in patterns for path in sorted(Path("ghuser").glob(pattern))]
