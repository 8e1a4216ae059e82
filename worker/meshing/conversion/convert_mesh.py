"""Converts a mesh of any format for Palpate. `palpate mesh` runs this program (mesh_conversion.hpp).

    python3 convert_mesh.py INPUT OUTPUT [--straight] [--weld]

Writes a mesh with tetrahedra in Gmsh's format 2.2, ASCII, with its groups. Writes a mesh of triangles alone as the bytes that
closed_surface.cpp reads: two int64 (points, triangles), the points as float64, the triangles as int32. The first line of stdout
is "volume" or "surface"; each further line is a note for the user. Exit code 2: the input is wrong; stderr has one sentence.
Exit code 3: a Python module (numpy or another) is missing; stderr has its name.

This program has its own readers for formats whose groups meshio loses (.inp, binary .msh), for formats that meshio does not
know (.feb, TetGen with ten nodes), and for plain surfaces, so that errors name the line. meshio reads everything else.
"""
import errno
import pathlib
import sys

from abaqus_file import read_abaqus
from body import Wrong, wrong
from checks import check_points, put_middles_right, refuse_other_volumes, weld
from febio_file import read_febio
from gmsh_file import read_gmsh
from meshio_file import read_by_meshio
from medit_file import read_medit
from surface_files import read_obj, read_off, read_ply, read_stl
from tetgen_files import read_tetgen
from vtk_file import read_vtk
from vtu_file import read_vtu
from written_mesh import triangles_of, write_surface, write_volume

READERS = {".stl": read_stl, ".obj": read_obj, ".off": read_off, ".ply": read_ply, ".node": read_tetgen,
           ".ele": read_tetgen, ".inp": read_abaqus, ".feb": read_febio, ".msh": read_gmsh,
           ".vtk": read_vtk, ".vtu": read_vtu, ".vtp": read_vtu, ".mesh": read_medit}


class Unwritable(Exception):
    """The output could not be written; the text gives the reason."""


def convert(source, output, straight, welded):
    """Converts a mesh. Returns "volume" or "surface", and the notes."""
    path = pathlib.Path(source)
    try:
        body = READERS.get(path.suffix.lower(), read_by_meshio)(path)
    except (ArithmeticError, LookupError, ValueError) as error:
        wrong(source, None, f"it is truncated, or its format does not match its extension ({error!r}); save it again, "
                            "or in another format")
    check_points(body, source)
    refuse_other_volumes(body, source)
    is_volume = any(kind.startswith("tetra") and len(cells) for kind, cells in body.blocks)
    if is_volume:
        put_middles_right(body, source, straight)
        if welded:
            weld(body)
    triangles = triangles_of(body)
    if not is_volume and not len(triangles):
        wrong(source, None, "there are neither tetrahedra nor triangles in it")
    try:
        if is_volume:
            write_volume(body, output)
        else:
            write_surface(body, triangles, output)
    except OSError as error:
        more = "; free some space, or set TMPDIR to another folder" if error.errno in (errno.ENOSPC, errno.EDQUOT) else ""
        raise Unwritable(f"{output}: cannot be written: {error.strerror or error}{more}") from None
    return ["volume" if is_volume else "surface", *body.notes]


def main(arguments):
    source, output, *flags = arguments
    try:
        print("\n".join(convert(source, output, "--straight" in flags, "--weld" in flags)))
    except Wrong as what:
        print(str(what).replace("\n", "?"), file=sys.stderr)  # one line, even if the name of the file has several
        return 2
    except Unwritable as why:
        print(why, file=sys.stderr)
        return 1
    except ModuleNotFoundError as missing:
        print(missing.name, file=sys.stderr)
        return 3
    except OSError as error:
        print(f"{error.filename or source}: {error.strerror or error}", file=sys.stderr)
        return 2
    except MemoryError:
        print(f"{source}: there is not enough memory to convert it", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
