"""Small files that other programs wrote, typed here: a box of 1 x 2 x 3 in each, or one tetrahedron."""

from __future__ import annotations

import base64

__all__ = ["LIB3MF_INCH", "MESHIO_VTU", "PYCOLLADA", "VTK_ASCII"]

LIB3MF_INCH = base64.b64decode(
    """
UEsDBC0AAAAIAAAAAAAfTKrX//////////8QABQAM0QvM2Rtb2RlbC5tb2RlbAEAEAC+BwAAAAAAAHQCAAAAAAAAnVXLcuMgEDwn
X6HijkEPS5YLJZe97HkrH4DQKGZLCJdArux+/Q6yFNsVxxvHJwM93T0zMBLPb6aLDjA4bfuKxCtOIuiVbXT/WpHRt3RDnp8ehbEN
dBFie1eRnff7LWNO7cBItzJaDdbZ1q+UNSxtjOzHVio/DkjClB2AJTxeM56QaOy1r4ju1Y4Etm0ngw709OXXtNG7rblTwEgPg5bd
SWSyud3fybMfbDMqj3WYmfLFUX0nUw3SdNJ7rabMiynzo6l7q+e6mQTLVyx+sIJ3tcBjefrXDhx4h7kl8RmXU3eSOVDjAMr2Hnof
KlUyni3ODh/IUtOutP1wKw62Gw2gMRUMJYzHC4X+KoU2eyyODh6SlMUJeXp8EAM4Ow4KHC4ehK1/g/KRbvBmk8j/2UNFpptMov32
5eXnD9znGaylaqhSxZpmBWxo3aaKFm1T1mWcQ1O2gRnZDLjd9O9B4IMJ3Z1UwlFYw1v0VhHKV2sefiT6gyt8UPPq77RaztiR6KuR
8TvpfwO/rXgReFPw2yneCPy64IVPLPCNkl7oXcR9CBPssqfi/dEsnVo2okM8XadDUpGURIe0Itjs975cwPBhBBhevpswjD9jwzF5
nQ0PAiyQ3hINagjDcRFgaPE62/oIm70h6U3YzIbo67BQiZPopyngTD1L4VPYnOksikHXRWe2kAlm+mkKgQa9zbATm2BLs44PWbDl
iQt2HB3Ye8HOZ4qoR901p+kBTZ7nm4yWbYnTQ+YJLZWsKedFndTZBnJeT9NDaA8mOpLO42iZQLLMUpkXnGYJb2imIKeSc0WbNfC2
LbIylykJ+Qs2iePXmE1D7OnxH1BLAwQtAAAACAAAAAAAJtSpJP//////////EwAUAFtDb250ZW50X1R5cGVzXS54bWwBABAASwIA
AAAAAADqAAAAAAAAAJ1SzUrEMBA+26cIuUqbqiAibfew6xv4AiGdttH8kUyX+vZOuioo1oLHycz3S5rDYg07Q0zau5bfVDVn4JTv
tRtbPuNQPvBDVzTPbwESo1uXWj4hhkchkprAylT5AI42g49WIo1xFEGqVzmCuK3re6G8Q3BYYubgXXHVnGCQs0H2tNDiovwSYOTs
eDnNai3XNlOsC7GJ+gfI+h7MDy0ZgtFKIrUgzq6vbCo/MlR3vZVuHqTCOVIrJc2Z4Joi8y1fwf3uK79vYSKYtOPqe9NfDgm5Ok+T
DulPXwgLpYAdmf3wnzyUpRHr3+iKd1BLAwQtAAAACAAAAAAAMGcBuf//////////CwAUAF9yZWxzLy5yZWxzAQAQAAcBAAAAAAAA
sgAAAAAAAABlj80KwjAQhM/2KcLe7aYWRMS0Fy9epS8Q0k1bbH5IUtG3N4KCxePOzH7MnNqHmdmdQpycFVCVHBhZ5frJDgKWpLcH
aJvidKVZphyJ4+Qjyz82ChhT8kfEqEYyMpbOk82OdsHIlM8woJfqJgfCHed7DL8MaIrNisq6p6c/pplUcNHpVCpnsO6NtIuWKi0h
F8zYqkZevXXX0wysk2GgJADr81csP9alF5AbcMA8B1d7muIFUEsBAi0ALQAAAAgAAAAAAB9Mqtf//////////xAAHAAAAAAAAACA
AAAA/////zNELzNkbW9kZWwubW9kZWwBABgAvgcAAAAAAAB0AgAAAAAAAAAAAAAAAAAAUEsBAi0ALQAAAAgAAAAAACbUqST/////
/////xMAHAAAAAAAAACAAAAA/////1tDb250ZW50X1R5cGVzXS54bWwBABgASwIAAAAAAADqAAAAAAAAALYCAAAAAAAAUEsBAi0A
LQAAAAgAAAAAADBnAbn//////////wsAHAAAAAAAAACAAAAA/////19yZWxzLy5yZWxzAQAYAAcBAAAAAAAAsgAAAAAAAADlAwAA
AAAAAFBLBgYsAAAAAAAAAC0ALQAAAAAAAAAAAAMAAAAAAAAAAwAAAAAAAAAMAQAAAAAAANQEAAAAAAAAUEsGBwAAAADgBQAAAAAA
AAEAAABQSwUGAAAAAAMAAwAMAQAA/////wAA
"""
)
"""The 3MF Consortium's own library wrote it, in inches."""

PYCOLLADA = """<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>
<created>2026-11-23T17:21:34.796464</created>
<modified>2026-11-23T17:21:34.796470</modified>
<up_axis>Y_UP</up_axis>
</asset>
<library_geometries>
<geometry id="1633099ba56547a394f809ee8049c3f2" name="58dec0c44eab4dfb9f59f01ce80f20b8">
<mesh>
<source id="verts-array">
<float_array count="24" id="verts-array-array">-0.5 -1 -1.5 -0.5 -1 1.5 -0.5 1 -1.5 -0.5 1 1.5
0.5 -1 -1.5 0.5 -1 1.5 0.5 1 -1.5 0.5 1 1.5</float_array>
<technique_common>
<accessor count="8" source="#verts-array-array" stride="3">
<param type="float" name="X"/>
<param type="float" name="Y"/>
<param type="float" name="Z"/>
</accessor>
</technique_common>
</source>
<vertices id="verts-array-vertices">
<input semantic="POSITION" source="#verts-array"/>
</vertices>
<triangles count="12" material="material0">
<input offset="0" semantic="VERTEX" source="#verts-array-vertices"/>
<input offset="1" semantic="TEXCOORD" source="#verts-array"/>
<p>1 1 3 3 0 0 4 4 1 1 0 0 0 0 3 3 2 2 2 2 4 4 0 0 1 1 7 7 3 3 5 5 1 1 4 4 5 5 7 7 1 1 3 3 7 7
2 2 6 6 4 4 2 2 2 2 7 7 6 6 6 6 5 5 4 4 7 7 5 5 6 6</p>
</triangles>
</mesh>
</geometry>
</library_geometries>
<library_visual_scenes>
<visual_scene id="scene">
<node id="node0" name="node0">
<instance_geometry url="#1633099ba56547a394f809ee8049c3f2">
</instance_geometry>
</node>
</visual_scene>
</library_visual_scenes>
<scene>
<instance_visual_scene url="#scene"/>
</scene>
</COLLADA>
"""
"""Of pycollada, by trimesh; without materials and normals."""

MESHIO_VTU = """<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian" compressor="vtkZLibDataCompressor">
<!--This file was created by meshio v5.3.5-->
<UnstructuredGrid>
<Piece NumberOfPoints="4" NumberOfCells="1">
<Points>
<DataArray type="Float64" Name="Points" NumberOfComponents="3" format="binary">
AQAAAACAAABgAAAAEgAAAA==eJxjYMAHPtjjlSZCHgB4XQOO
</DataArray>
</Points>
<Cells>
<DataArray type="Int64" Name="connectivity" format="binary">
AQAAAACAAAAgAAAAEwAAAA==eJxjYIAARijNBKWZoTQAAHAABw==
</DataArray>
<DataArray type="Int64" Name="offsets" format="binary">
AQAAAACAAAAIAAAACwAAAA==eJxjYYAAAAAoAAU=
</DataArray>
<DataArray type="Int64" Name="types" format="binary">
AQAAAACAAAAIAAAACwAAAA==eJzjYoAAAABYAAs=
</DataArray>
</Cells>
</Piece>
</UnstructuredGrid>
</VTKFile>
"""
"""Of meshio: one tetrahedron."""

VTK_ASCII = """# vtk DataFile Version 5.1
written by meshio v5.3.5
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 4 double
0.0 0.0 0.0 1.0 0.0 0.0 0.0 1.0 0.0 0.0 0.0 1.0
CELLS 2 4
OFFSETS vtktypeint64
0
4
CONNECTIVITY vtktypeint64
0
1
2
3
CELL_TYPES 1
10
"""
"""Of meshio, as legacy VTK: one tetrahedron."""
