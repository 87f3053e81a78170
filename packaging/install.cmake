# cmake --install and cpack -G DEB: the program, its page for man, cases, documents, the scripts of users and the Python
# package. share/eulastic is laid out as the source, so that scripts and package find each other.
include(GNUInstallDirs)
set(share ${CMAKE_INSTALL_DATADIR}/eulastic)
install(TARGETS eulastic)
install(DIRECTORY options DESTINATION ${share} FILES_MATCHING PATTERN *.opts PATTERN *.csv PATTERN *.stl PATTERN *.h5)
install(PROGRAMS scripts/run scripts/plot scripts/render scripts/compare_pressure_solvers scripts/make_vessel scripts/profile
  DESTINATION ${share}/scripts)
install(FILES scripts/environment scripts/eulastic DESTINATION ${share}/scripts)
install(DIRECTORY python/eulastic DESTINATION ${share}/python PATTERN __pycache__ EXCLUDE)
install(FILES README.md CHANGELOG.md CITATION.cff CONTRIBUTING.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} FILES_MATCHING PATTERN *.md PATTERN *.png PATTERN *.jpg PATTERN *.svg PATTERN *.csv)
file(RELATIVE_PATH cases /${CMAKE_INSTALL_DOCDIR} /${share}/options)  # for links of the documents
file(CREATE_LINK ${cases} ${PROJECT_BINARY_DIR}/options SYMBOLIC)
install(FILES ${PROJECT_BINARY_DIR}/options DESTINATION ${CMAKE_INSTALL_DOCDIR})

# On PATH: eulastic-run, eulastic-compare-pressure-solvers, ...
foreach(name run plot render compare_pressure_solvers make_vessel profile)
  file(RELATIVE_PATH script /${CMAKE_INSTALL_BINDIR} /${share}/scripts/${name})
  string(REPLACE _ - command eulastic-${name})
  file(CREATE_LINK ${script} ${PROJECT_BINARY_DIR}/${command} SYMBOLIC)
  install(FILES ${PROJECT_BINARY_DIR}/${command} DESTINATION ${CMAKE_INSTALL_BINDIR})
endforeach()

# The page for man is what the program says of itself; the system's Python finds the package in /usr alone.
install(CODE "
  execute_process(COMMAND \"$<TARGET_FILE:eulastic>\" -help man OUTPUT_FILE \"${PROJECT_BINARY_DIR}/eulastic.1\"
                  COMMAND_ERROR_IS_FATAL ANY)
  file(INSTALL \"${PROJECT_BINARY_DIR}/eulastic.1\" DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}/man1\")
  if(CMAKE_INSTALL_PREFIX STREQUAL /usr)
    file(CREATE_LINK ../../../${share}/python/eulastic \"${PROJECT_BINARY_DIR}/python_link/eulastic\" SYMBOLIC)
    file(INSTALL \"${PROJECT_BINARY_DIR}/python_link/eulastic\" DESTINATION /usr/lib/python3/dist-packages)
  endif()")
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/python_link)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_CONTACT "The Eulastic developers")
set(CPACK_PACKAGE_DESCRIPTION "Red blood cells and other soft bodies, drops, membranes and rigid vessels in incompressible
flow, with PETSc and MPI: eulastic, scripts around it (eulastic-run, eulastic-plot, eulastic-render), and a Python package.")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS openmpi-bin)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-h5py, python3-numpy, python3-matplotlib, python3-vtk9, xvfb, xauth, libgl1-mesa-dri")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/prerm)
include(CPack)
