# spack repo add packaging/spack && spack dev-build eulastic@1.0.0, in a clone.
from spack.package import *


class Eulastic(CMakePackage):
    """Soft bodies in incompressible flow on one fixed grid, with PETSc and MPI."""

    license("BSD-3-Clause")

    version("1.0.0")

    variant("fftw", default=True, description="the pressure solver SMAC")
    variant("int64", default=False, description="more than 2147483647 cells")

    depends_on("cxx", type="build")
    depends_on("c", type="build")
    depends_on("cmake@3.22:", type="build")
    depends_on("ninja", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("mpi")
    depends_on("petsc@3.18: +mpi ~complex precision=double")
    depends_on("petsc +int64", when="+int64")
    depends_on("petsc ~int64", when="~int64")
    depends_on("hdf5 +mpi")
    depends_on("fftw@3:", when="+fftw")
    depends_on("zlib-api")
    depends_on("python@3.9:", type="run")
    depends_on("py-numpy", type="run")
    depends_on("py-h5py", type="run")
    depends_on("py-matplotlib", type="run")

    generator("ninja")

    def cmake_args(self):
        return [
            self.define_from_variant("EULASTIC_FFTW", "fftw"),
            self.define("EULASTIC_TESTS", False),
            self.define("EULASTIC_BENCHMARKS", False),
        ]
