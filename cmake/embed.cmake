# Writes every YAML and CSV file below ROOT into one C++ initialiser list: {"path", "text"}, ...
file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/*.yaml ${ROOT}/*.csv)
list(SORT files)
set(text "")
foreach(file ${files})
  file(READ ${ROOT}/${file} content)
  string(APPEND text "{\"${file}\", R\"mocurate(${content})mocurate\"},\n")
endforeach()
file(WRITE ${OUTPUT} "${text}")
