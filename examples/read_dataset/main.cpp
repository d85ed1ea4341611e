// Reads a dataset with the installed package: cmake -S examples/read_dataset -B b -DCMAKE_PREFIX_PATH=PREFIX
#include <cstdio>

#include "core/store/store.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: read_dataset dataset.h5\n");
    return 2;
  }
  const auto dataset = mocurate::ReadDataset(argv[1]);
  if (!dataset) {
    std::fprintf(stderr, "%s\n", dataset.error().Message().c_str());
    return static_cast<int>(mocurate::ExitCodeOf(dataset.error().code));
  }
  for (const mocurate::Clip& clip : dataset->clips) {
    std::printf("%s  %s  %d frames\n", clip.id().c_str(), clip.label.c_str(), clip.motion->frame_count());
  }
  return 0;
}
