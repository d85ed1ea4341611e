# The fuzz targets: fuzz_NAME.cpp each, and what they and their seeds are linked with.
set(MOCURATE_FUZZ_TARGETS
  amass amc asf babel bandai_label bvh c3d camera_files checkpoint config depth_sequence expmap_table humanact12_pickle joint_layout
  joint_table mdm_results npy npz ntu_skeleton openpose opensim_table pattern pcd phspd_text pickle ply safetensors smpl_model span_table store
  torch_pickle trc uestc_info vibe_pickle where)
set(MOCURATE_FUZZ_LIBRARIES mocurate_config mocurate_formats mocurate_checkpoint mocurate_hdf5)
set(MOCURATE_FUZZ_SEEDS ${CMAKE_CURRENT_LIST_DIR}/seeds_binary.cpp ${CMAKE_CURRENT_LIST_DIR}/seeds_motion.cpp
  ${CMAKE_CURRENT_LIST_DIR}/seeds_noted.cpp ${CMAKE_CURRENT_LIST_DIR}/seeds_stored.cpp)
set(MOCURATE_FUZZ_PATTERN ${PROJECT_SOURCE_DIR}/ingest/sources/pattern.cpp)
set(MOCURATE_FUZZ_WHERE ${PROJECT_SOURCE_DIR}/canon/splits/leaks.cpp ${PROJECT_SOURCE_DIR}/canon/values/subset.cpp
  ${PROJECT_SOURCE_DIR}/canon/values/where.cpp ${PROJECT_SOURCE_DIR}/canon/values/where_parse.cpp)
