#include <sys/stat.h>

#include <algorithm>
#include <fstream>

#include "core/pipeline/cache_layout.h"
#include "core/pipeline/runner.h"
#include "tests/pipeline/runs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

class CacheOfArtifacts : public Runs {
 protected:
  Expected<Cache::Entry> Put(const std::string& key, const std::string& bytes) {
    return cache.Put(key, Source("temporary", bytes), {});
  }
  static void Age(const fs::path& path, double days) {
    const auto then = fs::file_time_type::clock::now() - std::chrono::hours(static_cast<long>(days * 24));
    if (fs::is_regular_file(path)) fs::last_write_time(path, then);
  }
  void AgeAll(double days) {
    for (const auto& entry : fs::recursive_directory_iterator(cache.folder())) Age(entry.path(), days);
  }

  Cache cache{folder / "cache"};
  const std::string one = Cache::Key(Stage("s"), Item("one"));
  const std::string two = Cache::Key(Stage("s"), Item("two"));
};

TEST_F(CacheOfArtifacts, ReturnsStoredEntries) {
  EXPECT_FALSE(cache.Find(one));
  StageOutcome outcome;
  outcome.kind = OutcomeKind::kSuspect;
  outcome.summary["frames"] = 12;
  const auto put = cache.Put(one, Source("temporary", "\x89HDF bytes"), outcome);
  ASSERT_TRUE(put) << put.error().Message();
  EXPECT_FALSE(fs::exists(folder / "temporary"));
  const auto found = cache.Find(one);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->outcome.kind, OutcomeKind::kSuspect);
  EXPECT_EQ(found->outcome.summary, outcome.summary);
  EXPECT_EQ(found->artifact, put->artifact);
  EXPECT_EQ(found->sha256.size(), 64u);
  EXPECT_EQ(found->artifact.extension(), ".h5");
  EXPECT_EQ(ReadFile(found->artifact).value(), "\x89HDF bytes");
}

TEST_F(CacheOfArtifacts, ARefusalIsAnEntryWithoutArtifact) {
  StageOutcome outcome;
  outcome.kind = OutcomeKind::kRefused;
  outcome.error = {ErrorCode::kMalformed, "no", "there", "so"};
  ASSERT_TRUE(cache.Put(one, {}, outcome));
  const auto found = cache.Find(one);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->artifact.empty());
  EXPECT_EQ(found->outcome.error, outcome.error);
}

TEST_F(CacheOfArtifacts, AMissingOrTruncatedArtifactIsNotServed) {
  const fs::path artifact = Put(one, "whole bytes")->artifact;
  fs::resize_file(artifact, 5);
  EXPECT_FALSE(cache.Find(one));
  ASSERT_TRUE(Put(one, "whole bytes"));
  ASSERT_TRUE(cache.Find(one));
  fs::remove(artifact);
  EXPECT_FALSE(cache.Find(one));
}

TEST_F(CacheOfArtifacts, ABrokenRecordIsNotServed) {
  ASSERT_TRUE(Put(one, "bytes"));
  const fs::path record = cache.folder() / "objects" / one.substr(0, 2) / one.substr(2, 2) / (one.substr(4) + ".json");
  ASSERT_TRUE(WriteFile(record, "{\"key\": 3"));
  EXPECT_FALSE(cache.Find(one));
  EXPECT_EQ(cache.Verify(), std::vector<std::string>{one});
}

/// Caches are handed on: a record may say anything.
TEST_F(CacheOfArtifacts, ARecordNamesAnObjectBesideItOrNothing) {
  const fs::path artifact = Put(one, "bytes")->artifact;
  const fs::path record = artifact.parent_path() / (one.substr(4) + ".json");
  const nlohmann::json text = nlohmann::json::parse(*ReadFile(record));
  ASSERT_TRUE(MakeFolder(folder / "thesis"));
  ASSERT_TRUE(WriteFile(folder / "thesis/chapter", "bytes"));
  const std::string digits = one.substr(4);
  for (const std::string& other :
       {std::string("../../../../thesis/chapter"), (folder / "thesis/chapter").native(), std::string("."),
        std::string(".."), digits, digits + ".json", digits + "-", digits + "-01234567/../../../../../thesis/chapter",
        digits + "-0123456g.h5", two.substr(4) + "-01234567.bin"}) {
    nlohmann::json hostile = text;
    hostile["artifact"] = other;
    ASSERT_TRUE(WriteFile(record, hostile.dump()));
    EXPECT_FALSE(cache.Find(one)) << other;
    EXPECT_EQ(cache.Verify().size(), 1u) << other;
  }
  DropObject(cache.folder(), folder / "thesis/chapter");
  DropObject(cache.folder(), cache.folder() / "objects/../../thesis/chapter");
  DropObject(cache.folder(), cache.folder() / "objects");
  EXPECT_TRUE(fs::exists(folder / "thesis/chapter"));
  EXPECT_TRUE(fs::exists(record));
  ASSERT_TRUE(WriteFile(record, text.dump()));
  ASSERT_TRUE(cache.Find(one));
  DropObject(cache.folder(), artifact);
  EXPECT_FALSE(fs::exists(artifact));
  EXPECT_FALSE(fs::exists(record));
}

TEST_F(CacheOfArtifacts, LinksAreNotFollowed) {
  ASSERT_TRUE(Put(one, "kept bytes"));
  const fs::path objects = cache.folder() / "objects", thesis = folder / "thesis";
  const std::string digits(60, 'a');
  ASSERT_TRUE(MakeFolder(thesis / "ab/cd"));
  for (const char* name : {"chapter", "ab/cd/chapter"}) ASSERT_TRUE(WriteFile(thesis / name, "text"));
  ASSERT_TRUE(WriteFile(thesis / (digits + ".json"), "{}"));
  ASSERT_TRUE(WriteFile(thesis / (digits + "-01234567.h5"), "bytes"));
  ASSERT_TRUE(MakeFolder(objects / "00/11"));
  fs::create_directory_symlink(thesis, objects / "ff");
  fs::create_directory_symlink(thesis, objects / "00/ff");
  fs::create_directory_symlink(thesis, objects / "00/11" / (digits + "-01234567"));
  ASSERT_TRUE(WriteFile(objects / "notes.txt", "mine"));
  ASSERT_TRUE(WriteFile(objects / "00/notes.txt", "mine"));
  fs::create_directory_symlink(thesis, cache.folder() / "scratch");
  EXPECT_EQ(cache.Stat().objects, 1u);
  EXPECT_EQ(cache.Prune(0.0).objects, 1u);
  for (const char* name : {"chapter", "ab/cd/chapter"}) EXPECT_TRUE(fs::exists(thesis / name)) << name;
  EXPECT_EQ(std::distance(fs::directory_iterator(thesis), {}), 4);
  EXPECT_TRUE(fs::exists(objects / "notes.txt"));
  EXPECT_TRUE(fs::exists(objects / "00/notes.txt"));

  fs::remove_all(objects);
  fs::create_directory_symlink(thesis, objects);
  const auto put = Put(two, "bytes");
  ASSERT_FALSE(put);
  EXPECT_EQ(put.error().code, ErrorCode::kCannotWrite);
  EXPECT_EQ(cache.Prune(0.0).objects, 0u);
  EXPECT_EQ(std::distance(fs::directory_iterator(thesis), {}), 4);
}

/// An artifact is copied into run folders: a link in it would copy what it points to.
TEST_F(CacheOfArtifacts, AnArtifactWithALinkOrAPipeIsNotServed) {
  const auto fill = [this](const fs::path& made) {
    ASSERT_TRUE(MakeFolder(made));
    ASSERT_TRUE(WriteFile(made / "page", "text"));
  };
  fill(folder / "made");
  const fs::path whole = cache.Put(one, folder / "made", {})->artifact;
  ASSERT_TRUE(cache.Find(one));
  fs::remove(whole / "page");
  ASSERT_TRUE(WriteFile(folder / "secret", "text"));
  fs::create_symlink(folder / "secret", whole / "page");
  EXPECT_FALSE(cache.Find(one));
  EXPECT_EQ(cache.Verify().size(), 1u);
  fs::remove_all(whole);
  ASSERT_EQ(mkfifo(whole.c_str(), 0600), 0);
  EXPECT_FALSE(cache.Find(one));
  EXPECT_EQ(cache.Verify().size(), 1u);
}

TEST_F(CacheOfArtifacts, ACacheThatOthersMayChangeIsSaid) {
  ASSERT_TRUE(Put(one, "bytes"));
  EXPECT_EQ(cache.OthersWhoWrite(), "");
  fs::permissions(cache.folder(), fs::perms::all);
  EXPECT_NE(cache.OthersWhoWrite(), "");
}

TEST_F(CacheOfArtifacts, TakesOutputsFromAnotherFileSystem) {
  std::string other = "/dev/shm/mocurate-XXXXXX";
  if (mkdtemp(other.data()) == nullptr) GTEST_SKIP() << "no /dev/shm";
  ASSERT_TRUE(WriteFile(fs::path(other) / "artifact", "far bytes"));
  const auto entry = cache.Put(one, fs::path(other) / "artifact", {});
  fs::remove_all(other);
  ASSERT_TRUE(entry) << entry.error().Message();
  EXPECT_EQ(ReadFile(entry->artifact), "far bytes");
  EXPECT_EQ(std::distance(fs::directory_iterator(entry->artifact.parent_path()), {}), 2) << "and its record";
}

TEST_F(CacheOfArtifacts, PermissionsOfRecordsFollowTheUmask) {
  EXPECT_EQ(Wait(Fork([&] {
              umask(077);
              const auto entry = Put(one, "bytes");
              if (!entry) return 1;
              for (const auto& file : fs::directory_iterator(entry->artifact.parent_path())) {
                if ((file.status().permissions() & fs::perms::mask) != (fs::perms::owner_read | fs::perms::owner_write))
                  return 2;
              }
              return 0;
            })),
            0);
}

TEST_F(CacheOfArtifacts, NothingIsPutThroughALink) {
  const fs::path outside = folder / "outside", objects = cache.folder() / "objects";
  ASSERT_TRUE(MakeFolder(outside) && MakeFolder(objects));
  for (const fs::path& link : {objects / one.substr(0, 2), objects}) {
    fs::remove_all(link);
    fs::create_directory_symlink(outside, link);
    const auto put = Put(one, "bytes");
    ASSERT_FALSE(put);
    EXPECT_EQ(put.error().code, ErrorCode::kCannotWrite);
    EXPECT_TRUE(fs::is_empty(outside));
  }
}

TEST_F(CacheOfArtifacts, VerifyFindsAnArtifactWhoseBytesChanged) {
  ASSERT_TRUE(Put(one, "good bytes"));
  const fs::path artifact = Put(two, "more bytes")->artifact;
  EXPECT_TRUE(cache.Verify().empty());
  std::ofstream(artifact) << "evil bytes";
  EXPECT_EQ(cache.Verify(), std::vector<std::string>{two});
}

TEST_F(CacheOfArtifacts, OtherBytesUnderOneKeyNeverMixWithTheFirst) {
  const Cache::Entry first = *Put(one, "first");
  const Cache::Entry second = *Put(one, "later");
  EXPECT_EQ(ReadFile(first.artifact).value(), "first");
  EXPECT_EQ(ReadFile(second.artifact).value(), "later");
  EXPECT_EQ(cache.Find(one)->sha256, second.sha256);
}

TEST_F(CacheOfArtifacts, AFolderIsAnArtifactToo) {
  for (int i = 0; i < 2; ++i) {
    const fs::path made = folder / "made";
    ASSERT_TRUE(MakeFolder(made / "sub"));
    ASSERT_TRUE(WriteFile(made / "sub" / "a", "aa"));
    ASSERT_TRUE(WriteFile(made / "b", "bbb"));
    ASSERT_TRUE(cache.Put(one, made, {}));
  }
  const auto found = cache.Find(one);
  ASSERT_TRUE(found);
  EXPECT_EQ(ReadFile(found->artifact / "sub" / "a").value(), "aa");
  EXPECT_EQ(cache.Stat().objects, 1u);
  EXPECT_TRUE(cache.Verify().empty());
  ASSERT_TRUE(WriteFile(found->artifact / "b", "ccc"));
  EXPECT_EQ(cache.Verify().size(), 1u);
}

TEST_F(CacheOfArtifacts, PruneRemovesUnusedEntries) {
  const fs::path old_artifact = Put(one, "old bytes")->artifact;
  AgeAll(40.0);
  ASSERT_TRUE(Put(two, "new"));
  EXPECT_EQ(cache.Stat().objects, 2u);
  const Cache::Statistics removed = cache.Prune(30.0);
  EXPECT_EQ(removed.objects, 1u);
  EXPECT_GT(removed.bytes, 9u);
  EXPECT_FALSE(cache.Find(one));
  EXPECT_FALSE(fs::exists(old_artifact));
  EXPECT_TRUE(cache.Find(two));
  EXPECT_EQ(cache.Prune(0.0).objects, 1u);
  EXPECT_EQ(cache.Stat().bytes, 0u);
}

TEST_F(CacheOfArtifacts, UseKeepsAnEntryFromBeingPruned) {
  ASSERT_TRUE(Put(one, "bytes"));
  AgeAll(40.0);
  ASSERT_TRUE(cache.Find(one));
  EXPECT_EQ(cache.Prune(30.0).objects, 0u);
  EXPECT_TRUE(cache.Find(one));
}

TEST_F(CacheOfArtifacts, TheKeyDependsOnStageVersionItemOptionsAndContentsOnly) {
  const ItemSpec spec{"clip", {{"rate_hz", 30.0}, {"trim", true}}, {{"evidence", "e", "/a", "11"}}};
  const std::string key = Cache::Key(Stage("canon", 2), spec);
  EXPECT_EQ(key.size(), 64u);
  ItemSpec moved = spec;
  moved.inputs[0].path = "/elsewhere";
  EXPECT_EQ(Cache::Key(Stage("canon", 2), moved), key);

  std::vector<std::string> keys = {key, Cache::Key(Stage("canon", 3), spec), Cache::Key(Stage("audit", 2), spec)};
  const auto other = [&](const std::function<void(ItemSpec&)>& change) {
    ItemSpec changed = spec;
    change(changed);
    keys.push_back(Cache::Key(Stage("canon", 2), changed));
  };
  other([](ItemSpec& s) { s.item = "clip2"; });
  other([](ItemSpec& s) { s.options.Set("rate_hz", 30.000001); });
  other([](ItemSpec& s) { s.options.Set("more", nullptr); });
  other([](ItemSpec& s) { s.inputs[0].role = "proportions"; });
  other([](ItemSpec& s) { s.inputs[0].name = "f"; });
  other([](ItemSpec& s) { s.inputs[0].sha256 = "12"; });
  other([](ItemSpec& s) { s.inputs.clear(); });
  other([](ItemSpec& s) { s.inputs.push_back(s.inputs[0]); });
  std::sort(keys.begin(), keys.end());
  EXPECT_EQ(std::unique(keys.begin(), keys.end()), keys.end());
}

TEST_F(CacheOfArtifacts, LiesInTheFolderOfTheEnvironmentVariable) {
  const std::string cache_before = std::getenv("XDG_CACHE_HOME") != nullptr ? std::getenv("XDG_CACHE_HOME") : "";
  setenv("MOCURATE_CACHE", "/somewhere", 1);
  EXPECT_EQ(DefaultCacheFolder(), "/somewhere");
  unsetenv("MOCURATE_CACHE");
  setenv("XDG_CACHE_HOME", "/caches", 1);
  EXPECT_EQ(DefaultCacheFolder(), "/caches/mocurate");
  unsetenv("XDG_CACHE_HOME");
  EXPECT_EQ(DefaultCacheFolder().filename(), "mocurate");
  EXPECT_EQ(DefaultCacheFolder().parent_path().filename(), ".cache");
  if (!cache_before.empty()) setenv("XDG_CACHE_HOME", cache_before.c_str(), 1);
}

}  // namespace
}  // namespace mocurate
