# cmake -DARCHIVE=... -DFOLDER=... -P unpack.cmake: unpacks test data that a Debian package brings.
if(NOT EXISTS ${ARCHIVE})
    message(FATAL_ERROR "${ARCHIVE} is missing; the package of Debian that has it is named in tools/setup.sh")
endif()
if(NOT EXISTS ${FOLDER})
    file(ARCHIVE_EXTRACT INPUT ${ARCHIVE} DESTINATION ${FOLDER}.new)
    file(RENAME ${FOLDER}.new ${FOLDER})
endif()
