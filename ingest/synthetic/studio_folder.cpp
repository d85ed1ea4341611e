#include "ingest/synthetic/studio_folder.h"

#include <algorithm>
#include <atomic>
#include <fstream>
#include <optional>
#include <thread>
#include <vector>

#include "core/base/file.h"
#include "core/formats/png.h"

namespace mocurate {

Status StudioFolder::Write(const std::string& name, std::string_view bytes) {
  const std::filesystem::path path = folder_ / name;
  if (Status made = MakeFolder(path.parent_path()); !made) return made;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) return Fail(ErrorCode::kCannotWrite, "the file could not be written", DisplayPath(path));
  const std::lock_guard<std::mutex> lock(mutex_);
  ++counts_.files;
  if (path.extension() == ".png") ++counts_.images;
  counts_.bytes += bytes.size();
  if (progress_) progress_(counts_);
  return {};
}

Status StudioFolder::WriteImage(const std::string& name, const DepthImage& image) {
  const Expected<std::string> png = EncodePng(image);
  if (!png) return Forward(png);
  return Write(name, *png);
}

void StudioFolder::AddTruth(const std::string& subject, const std::string& item, Motion motion) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++counts_.clips;
  counts_.frames += static_cast<std::size_t>(motion.frame_count());
  truth_[subject].motion.insert_or_assign(item + "#0-" + std::to_string(motion.frame_count()), std::move(motion));
}

Status StudioFolder::Finish(std::string_view studio_json) {
  if (Status made = MakeFolder(folder_ / "truth"); !made) return made;
  for (const auto& [subject, truth] : truth_) {
    if (Status written = WriteTruth(truth, folder_ / "truth" / (subject + ".h5")); !written) return written;
    ++counts_.files;
  }
  ++counts_.files;
  return WriteFile(folder_ / kWhole, studio_json);
}

Status StudioFolder::ForEach(std::size_t count, const std::function<Status(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  std::vector<std::optional<Error>> errors(count);
  const auto run = [&] {
    for (std::size_t i = next++; i < count && !failed; i = next++) {
      const Status done = work(i);
      if (done) continue;
      errors[i] = done.error();
      failed = true;
    }
  };
  std::vector<std::thread> threads;
  for (int t = 1; t < jobs_; ++t) threads.emplace_back(run);
  run();
  for (std::thread& thread : threads) thread.join();
  for (const std::optional<Error>& error : errors) {
    if (error) return tl::unexpected<Error>(*error);
  }
  return {};
}

StudioFolder::Counts StudioFolder::counts() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return counts_;
}

}  // namespace mocurate
