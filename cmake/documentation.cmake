# SPDX-License-Identifier: Apache-2.0
# The man page and shell completion, written by the program from its own table of commands.
include(GNUInstallDirs)
set(documentation ${PROJECT_BINARY_DIR}/documentation)
set(documentation_files ${documentation}/cluxel.1 ${documentation}/cluxel.bash ${documentation}/_cluxel ${documentation}/cluxel.fish)
add_custom_command(OUTPUT ${documentation_files}
  COMMAND ${CMAKE_COMMAND} -E make_directory ${documentation}
  COMMAND cluxel documentation --man > ${documentation}/cluxel.1
  COMMAND cluxel documentation --completion bash > ${documentation}/cluxel.bash
  COMMAND cluxel documentation --completion zsh > ${documentation}/_cluxel
  COMMAND cluxel documentation --completion fish > ${documentation}/cluxel.fish
  DEPENDS cluxel VERBATIM)
set(man_page ${documentation}/cluxel.1)
find_program(CLUXEL_GZIP gzip)
if(CLUXEL_GZIP)  # as Debian's policy asks; without name and time, so that it is reproducible
  set(man_page ${documentation}/cluxel.1.gz)
  add_custom_command(OUTPUT ${man_page} COMMAND ${CLUXEL_GZIP} -9nkf ${documentation}/cluxel.1
    DEPENDS ${documentation}/cluxel.1 VERBATIM)
endif()
add_custom_target(cluxel_documentation ALL DEPENDS ${documentation_files} ${man_page})
install(FILES ${man_page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
install(FILES ${documentation}/cluxel.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME cluxel COMPONENT program)
install(FILES ${documentation}/_cluxel DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions COMPONENT zsh)   # Debian's folder is another one: package.cmake
install(FILES ${documentation}/cluxel.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)
