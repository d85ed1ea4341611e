# Installs the built programs into a folder of its own, runs a small job there, and builds and runs
# examples/read_dataset against the installed package. Requires the variables BUILD, SOURCE, SCRATCH, CXX.
function(must_run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE errors)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "'${ARGV}' exited with ${result}:\n${output}\n${errors}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${SCRATCH})
set(prefix ${SCRATCH}/prefix)
set(ENV{MOCURATE_CACHE} ${SCRATCH}/cache)
must_run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
foreach(file bin/mocurate libexec/mocurate/mocurate-annotate libexec/mocurate/mocurate-video libexec/mocurate/mocurate-learn
    share/mocurate/configs/kard.yaml include/mocurate/core/store/store.h)
  if(NOT EXISTS ${prefix}/${file})
    message(FATAL_ERROR "${file} is not installed")
  endif()
endforeach()

must_run(${prefix}/bin/mocurate run --output ${SCRATCH}/run --to assemble --quiet
  --set "ingest.synthetic.actions=[kick, wave]" --set ingest.synthetic.subjects=2 --set ingest.synthetic.repetitions=1
  --set "ingest.synthetic.duration=1 s" --set "assemble.splits=[]")

must_run(${CMAKE_COMMAND} -S ${SOURCE}/examples/read_dataset -B ${SCRATCH}/example -G Ninja
  -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_CXX_COMPILER=${CXX})
must_run(${CMAKE_COMMAND} --build ${SCRATCH}/example)
must_run(${SCRATCH}/example/read_dataset ${SCRATCH}/run/dataset.h5)
string(REGEX MATCHALL "[^\n]* (kick|wave)  [1-9][0-9]* frames" clips "${output}")
list(LENGTH clips count)
if(NOT count EQUAL 4)
  message(FATAL_ERROR "the example lists ${count} of 4 clips:\n${output}")
endif()

execute_process(COMMAND ${SCRATCH}/example/read_dataset ${SCRATCH}/none.h5 RESULT_VARIABLE result ERROR_VARIABLE errors)
if(NOT result EQUAL 3 OR NOT errors MATCHES "none.h5")
  message(FATAL_ERROR "the example exited with ${result} for a missing dataset, expected 3: ${errors}")
endif()
file(REMOVE_RECURSE ${SCRATCH})
