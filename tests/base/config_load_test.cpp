#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/file.h"
#include "core/base/resources.h"
#include "tests/base/config_message.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

using ::testing::HasSubstr;

/// Reads main.yaml of a folder.
std::string LoadMessage(const ScratchFolder& folder) {
  const auto node = LoadConfig(folder / "main.yaml");
  return node ? "" : node.error().Message();
}

TEST(ConfigInclude, LaterAndInnerValuesWin) {
  const ScratchFolder folder;
  ASSERT_TRUE(MakeFolder(folder / "sub"));
  ASSERT_TRUE(WriteFile(folder / "sub/a.yaml",
                        "seed: 1\nheight: 1\npeople: [a, b]\npath: d\ntrim: {enabled: false, still_speed: 1}\n"));
  ASSERT_TRUE(WriteFile(folder / "b.yaml", "seed: 2\nangle: 1\n"));
  ASSERT_TRUE(WriteFile(folder / "main.yaml",
                        "include: [sub/a.yaml, b.yaml]\nangle: 2\npeople: [c]\ntrim:\n  still_speed: 2 m/s\n"));
  const auto node = LoadConfig(folder / "main.yaml");
  ASSERT_TRUE(node) << node.error().Message();
  const auto options = OptionsFromConfig<SampleOptions>(*node);
  ASSERT_TRUE(options) << options.error().Message();
  EXPECT_EQ(options->seed, 2);
  EXPECT_EQ(options->height, 1.0);
  EXPECT_EQ(options->angle, 2.0);
  EXPECT_EQ(options->people, (std::vector<std::string>{"c"})) << "lists are replaced, not joined";
  EXPECT_FALSE(options->trim.enabled) << "mappings are merged";
  EXPECT_EQ(options->trim.still_speed, 2.0);
  EXPECT_EQ(options->path, folder / "sub/d") << "relative to the file that sets it";
}

TEST(ConfigInclude, ProblemsOfIncludedFilesAreReportedThere) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteFile(folder / "a.yaml", "seed: 1\nseed: 2\n"));
  ASSERT_TRUE(WriteFile(folder / "main.yaml", "include: [a.yaml, none.yaml, [x]]\n"));
  const std::string root = folder.path().native();
  EXPECT_EQ(LoadMessage(folder), root + "/a.yaml:2:1: key 'seed' appears twice, first in line 1 (keep one of them)\n" +
                                     root + "/main.yaml:1:19: cannot include 'none.yaml': no such file (" + root +
                                     "/none.yaml)\n" + root +
                                     "/main.yaml:1:30: include must be a path or a list of paths");
}

TEST(ConfigInclude, ACircleIsRefused) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteFile(folder / "main.yaml", "include: ./main.yaml\n"));
  EXPECT_EQ(LoadMessage(folder), (folder / "main.yaml").native() + ":1:10: './main.yaml' includes itself");
  ASSERT_TRUE(WriteFile(folder / "main.yaml", "include: a.yaml\n"));
  ASSERT_TRUE(WriteFile(folder / "a.yaml", "include: main.yaml\n"));
  EXPECT_EQ(LoadMessage(folder),
            (folder / "a.yaml").native() + ":1:10: 'main.yaml' includes itself, by way of 'a.yaml'");
}

TEST(ConfigInclude, FilesThatIncludeTwiceCannotGrowWithoutBound) {
  const ScratchFolder folder;
  for (int i = 0; i < 20; ++i) {
    const std::string next = "f" + std::to_string(i + 1) + ".yaml";
    ASSERT_TRUE(WriteFile(folder / ("f" + std::to_string(i) + ".yaml"), "include: [" + next + ", " + next + "]\n"));
  }
  ASSERT_TRUE(WriteFile(folder / "f20.yaml", "seed: 1\n"));
  ASSERT_TRUE(WriteFile(folder / "main.yaml", "include: f0.yaml\n"));
  EXPECT_THAT(LoadMessage(folder), HasSubstr("too many includes (at most 32 deep and 256 in all)"));
}

TEST(ConfigInclude, FilesBeyondTheLimitsAreNotRead) {
  const ScratchFolder folder;
  ASSERT_TRUE(WriteFile(folder / "a.yaml", "title: a\n"));
  std::string list;
  for (int i = 0; i < 300; ++i) list += (i > 0 ? ", " : "") + std::string(i < 256 ? "a.yaml" : "none.yaml");
  ASSERT_TRUE(WriteFile(folder / "main.yaml", "include: [" + list + "]\n"));
  EXPECT_THAT(LoadMessage(folder), HasSubstr("too many includes"));
  EXPECT_EQ(LoadMessage(folder).find("none.yaml"), std::string::npos);
}

TEST(ConfigInclude, EmbeddedFilesAreFoundByName) {
  const std::vector<std::string> paths = ResourcePaths();
  if (paths.empty()) GTEST_SKIP() << "nothing is embedded";
  const std::string name = paths.front();
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) ::setenv("MOCURATE_DATA", "data", 1);  // embedded configurations may refer to it
  const ScratchFolder folder;
  ASSERT_TRUE(WriteFile(folder / "main.yaml", "include: resource:" + name + "\nown: 1\n"));
  const auto node = LoadConfig(folder / "main.yaml");
  ASSERT_TRUE(node) << node.error().Message();
  EXPECT_GT(node->mapping.size(), 1u);
  EXPECT_TRUE(LoadConfig("resource:" + name));
  if (data == nullptr) ::unsetenv("MOCURATE_DATA");
  ASSERT_TRUE(WriteFile(folder / "main.yaml", "include: resource:" + name + "x\n"));
  EXPECT_THAT(LoadMessage(folder),
              HasSubstr("the embedded file does not exist (resource:" + name + "x) (did you mean '" + name));
}

TEST(ConfigInclude, MayNameTheEnvironment) {
  const ScratchFolder folder;
  ::setenv("MOCURATE_CONFIG_TEST", folder.path().c_str(), 1);
  ASSERT_TRUE(WriteFile(folder / "a.yaml", "seed: 5\n"));
  const auto node = LoadConfig(ConfigSource{"include: ${MOCURATE_CONFIG_TEST}/a.yaml", "c.yaml", "folder"}, {}, {true});
  ASSERT_TRUE(node) << node.error().Message();
  EXPECT_EQ(node->Find("seed")->scalar, "5");
  ::unsetenv("MOCURATE_CONFIG_TEST");
  EXPECT_EQ(MessageOf("include: ${MOCURATE_CONFIG_TEST}/a.yaml"),
            "c.yaml:1:10: ${MOCURATE_CONFIG_TEST} names no environment variable (include: cannot use keys) (export "
            "MOCURATE_CONFIG_TEST=..., or give the value with --set)");
}

TEST(ConfigInclude, FilesOutsideOfTheFolderNeedAPermission) {
  const ScratchFolder folder, outside;
  ASSERT_TRUE(MakeFolder(folder / "jobs/sub"));
  const std::string secret = "seed: 5\nTOP-SECRET: 1\nTOP-SECRET: 2\n";
  ASSERT_TRUE(WriteFile(outside / "a.yaml", secret));
  ASSERT_TRUE(WriteFile(folder / "beside.yaml", secret));
  ASSERT_TRUE(WriteFile(folder / "jobs/inner.yaml", "seed: 5\n"));
  std::filesystem::create_symlink(outside / "a.yaml", folder / "jobs/link.yaml");
  std::filesystem::create_directory_symlink(outside.path(), folder / "jobs/linked");
  ASSERT_TRUE(WriteFile(folder / "jobs/sub/up.yaml", "include: ../../beside.yaml\n"));
  const auto load = [&](const std::string& name, bool allowed) {
    EXPECT_TRUE(WriteFile(folder / "jobs/main.yaml", "include: " + name + "\n"));
    return LoadConfig(folder / "jobs/main.yaml", {}, {allowed});
  };
  for (const std::string& name :
       {(outside / "a.yaml").native(), std::string("../beside.yaml"), std::string("link.yaml"),
        std::string("linked/a.yaml"), std::string("sub/../../beside.yaml"), std::string("sub/up.yaml"),
        std::string("/etc/passwd")}) {
    const auto node = load(name, false);
    ASSERT_FALSE(node) << name;
    EXPECT_EQ(node.error().code, ErrorCode::kConfig);
    const std::string message = node.error().Message();
    EXPECT_THAT(message, HasSubstr("--allow-include"));
    EXPECT_THAT(message, HasSubstr(name == "sub/up.yaml" ? "up.yaml:1:10" : "main.yaml:1:10"));
    EXPECT_EQ(message.find("TOP-SECRET"), std::string::npos) << name;
    EXPECT_EQ(message.find("root:"), std::string::npos) << name;
  }
  for (const char* name : {"inner.yaml", "sub/../inner.yaml", "./inner.yaml"}) {
    const auto node = load(name, false);
    ASSERT_TRUE(node) << node.error().Message();
    EXPECT_EQ(node->Find("seed")->scalar, "5");
  }
  ASSERT_TRUE(WriteFile(folder / "beside.yaml", "seed: 5\n"));
  const auto allowed = load("../beside.yaml", true);
  ASSERT_TRUE(allowed) << allowed.error().Message();
  EXPECT_EQ(allowed->Find("seed")->scalar, "5");
}

TEST(ConfigInclude, OnlyRegularFilesOfABoundedSizeAreRead) {
  const ScratchFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe.yaml").c_str(), 0600), 0);
  ASSERT_TRUE(MakeFolder(folder / "folder.yaml"));
  for (const char* name : {"large.yaml", "more.yaml"})
    ASSERT_TRUE(WriteFile(folder / name, "# " + std::string(9 << 20, 'x')));
  ASSERT_TRUE(WriteFile(folder / "huge.yaml", "# " + std::string(16 << 20, 'x')));
  for (const char* name : {"/dev/zero", "pipe.yaml", "folder.yaml", "huge.yaml", "[large.yaml, more.yaml]"}) {
    ASSERT_TRUE(WriteFile(folder / "main.yaml", std::string("include: ") + name + "\n"));
    const auto node = LoadConfig(folder / "main.yaml", {}, {true});
    ASSERT_FALSE(node) << name;
    EXPECT_THAT(node.error().where, HasSubstr("main.yaml:1:"));
  }
  for (const char* name : {"pipe.yaml", "folder.yaml", "huge.yaml"}) {
    EXPECT_EQ(LoadData(folder / name).error().code, ErrorCode::kUnreadable) << name;
  }
  EXPECT_EQ(LoadConfig("/dev/zero").error().code, ErrorCode::kUnreadable);
}

TEST(ConfigInclude, AConfigurationOfACommandLineMayBeAPipe) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ASSERT_EQ(::write(ends[1], "seed: 6\n", 8), 8);
  ::close(ends[1]);
  const auto node = LoadConfig("/dev/fd/" + std::to_string(ends[0]));
  ::close(ends[0]);
  ASSERT_TRUE(node) << node.error().Message();
  EXPECT_EQ(node->Find("seed")->scalar, "6");
}

TEST(ConfigData, NamesNeitherTheEnvironmentNorOtherFiles) {
  ::setenv("MOCURATE_CONFIG_TEST", "TOP-SECRET", 1);
  const auto node = LoadData(
      ConfigSource{"include: a.yaml\ntitle: ${MOCURATE_CONFIG_TEST}\nnote: [\"a $${b} ${\", '$$${c}']\nkey: ${title}\n",
                   "d.yaml",
                   {}});
  ::unsetenv("MOCURATE_CONFIG_TEST");
  ASSERT_TRUE(node) << node.error().Message();
  EXPECT_EQ(node->Find("include")->scalar, "a.yaml");
  EXPECT_EQ(node->Find("title")->scalar, "${MOCURATE_CONFIG_TEST}");
  EXPECT_EQ(node->Find("key")->scalar, "${title}");
  EXPECT_EQ(node->Find("note")->sequence[0].scalar, "a ${b} ${");
  EXPECT_EQ(node->Find("note")->sequence[1].scalar, "$${c}");
}

TEST(Config, AMissingFileIsNotFound) {
  const auto node = LoadConfig("no/such.yaml");
  ASSERT_FALSE(node);
  EXPECT_EQ(node.error(), (Error{ErrorCode::kNotFound, "no such file", "no/such.yaml", ""}));
}

TEST(ConfigSet, AssignsByPath) {
  const auto options =
      ReadSample("joints: [{name: a}, {name: b}]\npath: x\npeople: [p]",
                 {"seed=9", "trim.still_speed=1 m/s", "joints.1.name=c=d", "path=here", "labels={a: b}", "people=[]"});
  ASSERT_TRUE(options) << options.error().Message();
  EXPECT_EQ(options->seed, 9);
  EXPECT_EQ(options->trim.still_speed, 1.0);
  EXPECT_EQ(options->joints[0].name, "a");
  EXPECT_EQ(options->joints[1].name, "c=d");
  EXPECT_EQ(options->path, "here") << "relative to the current folder";
  EXPECT_EQ(options->labels.at("a"), "b");
  EXPECT_TRUE(options->people.empty());
}

TEST(ConfigProfiles, TheNamedOneOverridesTheConfigAndTheCommandLineOverridesIt) {
  const ConfigSource source{
      "profile: slow\nsteps: 10\ninner: {a: 1, b: 2}\nprofiles: {slow: {steps: 99}, quick: {steps: 1, inner: {b: "
      "5}}}\n",
      "c.yaml",
      {}};
  const auto steps = [&](const std::vector<std::string>& assignments) {
    const auto node = LoadConfig(source, assignments);
    EXPECT_TRUE(node) << node.error().Message();
    EXPECT_EQ(node->Find("profiles"), nullptr);
    return node->Find("steps")->scalar;
  };
  EXPECT_EQ(steps({}), "99");
  EXPECT_EQ(steps({"profile=quick"}), "1");
  EXPECT_EQ(steps({"profile=quick", "steps=7"}), "7");
  EXPECT_EQ(steps({"profile=''"}), "10");
  const auto merged = LoadConfig(source, {"profile=quick"});
  EXPECT_EQ(merged->Find("inner")->Find("a")->scalar, "1");
  EXPECT_EQ(merged->Find("inner")->Find("b")->scalar, "5");
  EXPECT_FALSE(LoadConfig(source, {"profile=quik"}));
}

TEST(ConfigSet, ReportsWhatCannotBeAssigned) {
  EXPECT_EQ(MessageOf("seed: 1\njoints: [{}]", {"seed", "=3", "a..b=1", "seed.x=1", "joints.1.name=x", "title=[a"}),
            "--set: 'seed' must be KEY=VALUE (e.g. --set canon.trim.margin='40 ms')\n"
            "--set: '=3' must be KEY=VALUE (e.g. --set canon.trim.margin='40 ms')\n"
            "--set: 'a..b=1' must be KEY=VALUE (e.g. --set canon.trim.margin='40 ms')\n"
            "--set: 'seed' is a single value, it has no 'x'\n"
            "--set: 'joints' is a list of 1, '1' is not one of its positions (positions: 0 to 0)\n"
            "--set title:1:1: not YAML: end of sequence flow not found");
  EXPECT_EQ(MessageOf("", {"seed=x", "trim.sped=1"}),
            "--set: seed: 'x' must be a whole number\n"
            "--set: unknown option 'trim.sped' (known here: enabled, still_speed)");
}

}  // namespace
}  // namespace mocurate
