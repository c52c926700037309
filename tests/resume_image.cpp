// Renders that are killed and resumed, and renders in parts, against an undisturbed one: the same bits.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <thread>

#include "../host/checkpoint_lock.h"
#include "../host/choices.h"
#include "checkpoint_cases.h"
#include "exr_reader.h"
#include "files.h"
#include "program.h"
#include "temporary_directory.h"

namespace {

using namespace oclair;
using namespace oclair::test;
namespace fs = std::filesystem;

const fs::path scenes = fs::path(OCLAIR_TEST_DIRECTORY).parent_path() / "scenes";

// Nothing in the header of an image may differ between two equal runs.
class resume_image : public testing::Test {
 protected:
  resume_image() { setenv("SOURCE_DATE_EPOCH", "0", 1); }
  ~resume_image() override { unsetenv("SOURCE_DATE_EPOCH"); }

  // Arguments of a render of cornell.xml to this name in the directory; its checkpoint stays.
  std::vector<std::string> render(const std::string& name, std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"render",       (scenes / "cornell.xml").string(), "--size", "24x16", "-o",
                                          image_of(name), "--checkpoint",                    checkpoint_of(name)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  std::string image_of(const std::string& name) const { return directory / (name + ".exr"); }
  std::string checkpoint_of(const std::string& name) const { return directory / (name + ".checkpoint"); }

  void expect_same_files(const std::string& a, const std::string& b) const {
    EXPECT_TRUE(content(image_of(a)) == content(image_of(b)));
    expect_same_film(read_checkpoint(checkpoint_of(a)).film, read_checkpoint(checkpoint_of(b)).film);
  }

  // Of a render that makes a checkpoint every 0.2 s, with a fault that begins after the first one and is there at the end.
  ProgramResult render_with_fault(const std::function<void(pid_t)>& fault) const {
    const ProgramResult result = run_oclair(render("a", {"--time", "4s", "--every", "0.2s"}), [&](pid_t process) {
      while (!fs::exists(checkpoint_of("a")) && !has_ended(process)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      fault(process);
    });
    EXPECT_EQ(result.exit, 1) << result.err;
    return result;
  }
  void expect_to_go_on() const {
    const std::string samples = std::to_string(read_checkpoint(checkpoint_of("a")).film.samples + 5);
    ASSERT_EQ(run_oclair(render("a", {"--spp", samples, "--resume"})).exit, 0);
    ASSERT_EQ(run_oclair(render("whole", {"--spp", samples})).exit, 0);
    expect_same_files("a", "whole");
  }

  const TemporaryDirectory directory;
};

double seconds_of(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// Until 50 kills are done; a render that comes to its end meanwhile is compared, and the next one begins. The moments are
// spread over the time that an undisturbed run takes: some fall before the first checkpoint, some among the passes, some
// into writing.
TEST_F(resume_image, a_render_killed_at_random_ends_with_the_bits_of_an_undisturbed_one) {
  const auto arguments = [this](const std::string& name, std::vector<std::string> more) {
    more.insert(more.end(), {"--spp", "600", "--sampler", "sobol"});
    return render(name, more);
  };
  double undisturbed = 0;
  for (int run = 0; run < 2; ++run)  // the first one compiles the kernel
    undisturbed = seconds_of([&] { EXPECT_EQ(run_oclair(arguments("whole", {"--restart"})).exit, 0); });
  Random random(1);
  std::uint64_t samples = 0;
  int kills = 0, ends = 0, with_checkpoint = 0;
  while (kills < 50 || ends == 0) {
    const double patience = kills < 50 ? random.between(0.0, 1.2 * undisturbed) : 60.0 * undisturbed + 60.0;
    const ProgramResult result = run_oclair_for(patience, arguments("killed", {"--resume", "--every", "0.01s"}));
    if (result.exit == 0) {
      ++ends;
      samples = 0;
      expect_same_files("killed", "whole");
      fs::remove(checkpoint_of("killed"));
      fs::remove(image_of("killed"));
      continue;
    }
    ASSERT_EQ(result.exit, 128 + 9) << result.err;
    ++kills;
    if (fs::exists(checkpoint_of("killed"))) {
      ++with_checkpoint;
      const std::uint64_t kept = read_checkpoint(checkpoint_of("killed")).film.samples;  // throws if it is broken
      EXPECT_GE(kept, samples);
      samples = kept;
    }
    if (fs::exists(image_of("killed"))) {
      EXPECT_FALSE(read_exr(image_of("killed")).channels.empty());  // likewise
    }
  }
  EXPECT_GT(with_checkpoint, 10);
  for (const std::string& name : directory.names())
    EXPECT_TRUE(name.starts_with("whole.") || name.starts_with("killed.")) << name;
}

TEST_F(resume_image, a_second_render_into_one_checkpoint_is_refused) {
  const CheckpointLock lock(checkpoint_of("a"));
  const ProgramResult result = run_oclair(render("a", {"--spp", "1"}));
  EXPECT_EQ(result.exit, 1);
  EXPECT_NE(result.err.find("a.checkpoint: is being written by process " + std::to_string(getpid())), std::string::npos)
      << result.err;
  EXPECT_EQ(directory.names(), std::vector<std::string>{"a.checkpoint.lock"});
}

TEST_F(resume_image, a_render_that_is_given_more_samples_ends_with_the_bits_of_one_that_had_them_at_once) {
  ASSERT_EQ(run_oclair(render("grown", {"--spp", "23"})).exit, 0);
  ASSERT_EQ(run_oclair(render("grown", {"--spp", "40", "--resume"})).exit, 0);
  ASSERT_EQ(run_oclair(render("whole", {"--spp", "40"})).exit, 0);
  expect_same_files("grown", "whole");
}

// The checkpoint says that another device made it, or another driver, or does not say.
TEST_F(resume_image, going_on_with_another_device_or_driver_is_warned_of_with_both) {
  ASSERT_EQ(run_oclair(render("a", {"--spp", "2"})).exit, 0);
  const Checkpoint own = read_checkpoint(checkpoint_of("a"));
  const auto text_of = [&](const std::string& name) {
    for (const auto& [entry, value] : own.head.attributes)
      if (entry == name) return value;
    return std::string("absent");
  };
  const std::string device = text_of("device"), driver = text_of("driver"),
                    samples = ": the samples are as good, but their bits may differ\n";
  const auto resumed = [&](const std::string& other_device, const std::string& other_driver) {
    Checkpoint changed = own;
    for (auto& [name, value] : changed.head.attributes) {
      if (name == "device") value = other_device;
      if (name == "driver") value = other_driver;
    }
    write_checkpoint(checkpoint_of("a"), changed);
    const ProgramResult result = run_oclair(render("a", {"--spp", "3", "--resume"}));
    EXPECT_EQ(result.exit, 0) << result.err;
    return result.err;
  };
  const std::string goes_on = " and goes on with " + device + " (" + driver + ")" + samples;
  EXPECT_EQ(resumed(device, driver).find("goes on"), std::string::npos);
  for (const auto& [d, v] :
       {std::pair<std::string, std::string>{"Abacus 9", driver}, {device, "Beads 1.0"}, {"two\nlines", "Beads"}}) {
    const std::string err = resumed(d, v), one_line = d == "two\nlines" ? "two?lines" : d;
    EXPECT_NE(err.find("a.checkpoint: was rendered by " + one_line + " (" + v + ")" + goes_on), std::string::npos) << err;
  }
  Checkpoint silent = own;
  silent.head.attributes.clear();
  write_checkpoint(checkpoint_of("a"), silent);
  const ProgramResult result = run_oclair(render("a", {"--spp", "3", "--resume"}));
  EXPECT_EQ(result.exit, 0);
  EXPECT_NE(result.err.find("was rendered by an unknown device" + goes_on), std::string::npos) << result.err;
}

TEST_F(resume_image, a_checkpoint_of_another_render_is_refused_with_all_that_differs_and_kept) {
  ASSERT_EQ(run_oclair(render("a", {"--spp", "2", "--sampler", "independent"})).exit, 0);
  const std::string before = content(checkpoint_of("a"));
  const std::pair<std::vector<std::string>, std::vector<std::string>> others[] = {
      {{"--seed", "9", "--sampler", "independent"}, {"seed is 0, expected 9"}},
      {{"--sampler", "sobol", "--max-depth", "3"}, {"sampler is independent, expected sobol", "max depth is "}},
      {{"--sampler", "independent", "--arithmetic", "double"}, {"arithmetic is float, expected double"}}};
  for (const auto& [options, differences] : others) {
    std::vector<std::string> arguments = {"--spp", "4", "--resume"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ProgramResult result = run_oclair(render("a", arguments));
    EXPECT_EQ(result.exit, 1);
    for (const std::string& difference : differences)
      EXPECT_NE(result.err.find(difference), std::string::npos) << difference << " is missing in:\n" << result.err;
    EXPECT_TRUE(content(checkpoint_of("a")) == before);
  }
}

// The limit lies between the sizes of an image and of a checkpoint, 70 kB.
TEST_F(resume_image, a_disk_that_fills_up_keeps_the_last_checkpoint) {
  sighandler_t before = signal(SIGXFSZ, SIG_IGN);  // also in the program
  const ProgramResult result = render_with_fault([](pid_t process) {
    rlimit room{};
    prlimit(process, RLIMIT_FSIZE, nullptr, &room);
    room.rlim_cur = 20000;
    EXPECT_EQ(prlimit(process, RLIMIT_FSIZE, &room, nullptr), 0);
  });
  signal(SIGXFSZ, before);
  EXPECT_NE(result.err.find("warning: " + checkpoint_of("a") + ": cannot be written: File too large, expected room"),
            std::string::npos)
      << result.err;
  expect_to_go_on();
}

TEST_F(resume_image, a_checkpoint_replaced_by_a_directory_is_warned_of_and_the_directory_kept) {
  const fs::path checkpoint = checkpoint_of("a"), saved = directory / "saved";
  const ProgramResult result = render_with_fault([&](pid_t) {
    for (std::error_code ignored; !fs::is_directory(checkpoint);) {  // it may be written anew between the two
      fs::rename(checkpoint, saved, ignored);
      fs::create_directory(checkpoint, ignored);
    }
    std::ofstream(checkpoint / "inside") << "kept";
  });
  EXPECT_NE(result.err.find("warning: " + checkpoint.string() + ": is a directory, expected the name of a file"),
            std::string::npos)
      << result.err;
  EXPECT_EQ(content(checkpoint / "inside"), "kept");
  fs::remove_all(checkpoint);
  fs::rename(saved, checkpoint);
  expect_to_go_on();
}

// The line of docs/farm.md with xargs in the place of parallel: processes of their own, two at a time.
TEST_F(resume_image, parts_by_separate_processes_are_merged_to_the_bits_of_a_single_render) {
  for (const std::string sampler : {"independent", "sobol"}) {
    const std::string oclair = std::string("'") + OCLAIR_PROGRAM + "'", at = "'" + (directory / "").string();
    const std::string parts = "seq 0 3 | xargs -P 2 -I{} sh -c \"" + oclair + " render '" +
                              (scenes / "cornell.xml").string() + "' --size 24x16 --sampler " + sampler +
                              " --samples \\$((32*{})):32 --resume -o " + at + "part-{}.exr'\"";
    const std::string merging = oclair + " merge " + at + "'part-*.checkpoint -o '" + image_of("merged") + "' --checkpoint '" +
                                checkpoint_of("merged") + "'";
    ASSERT_EQ(std::system(("(" + parts + " && " + merging + ") >/dev/null 2>&1").c_str()), 0) << parts << "\n" << merging;
    ASSERT_EQ(run_oclair(render("whole", {"--spp", "128", "--sampler", sampler, "--restart"})).exit, 0);
    expect_same_files("merged", "whole");
    EXPECT_TRUE(fs::remove(checkpoint_of("merged")));
    for (int k = 0; k < 4; ++k)
      for (const char* ending : {".exr", ".checkpoint"})
        EXPECT_TRUE(fs::remove(directory / ("part-" + std::to_string(k) + ending)));
  }
}

// On a scene where each option matters, two models of Oren-Nayar among its surfaces, so that naming the approximations would not tell
// what became of the other.
TEST_F(resume_image, samples_of_other_options_are_never_mixed) {
  const std::string file = directory / "scene.xml";
  put(file, R"(<scene version="3.0.0"><integrator type="path"><integer name="max_depth" value="6"/></integrator>
    <sensor type="perspective"><transform name="to_world"><lookat origin="0,-4,1" target="0,0,0" up="0,0,1"/></transform></sensor>
    <emitter type="constant"/>
    <shape type="rectangle"><bsdf type="roughdiffuse"><float name="alpha" value="0.5"/></bsdf></shape>
    <shape type="sphere"><bsdf type="roughdiffuse"><float name="alpha" value="0.5"/><boolean name="use_fast_approx" value="true"/></bsdf>
      <transform name="to_world"><scale value="0.3"/><translate x="-0.5" z="0.4"/></transform></shape>
    <shape type="sphere"><bsdf type="dielectric"/><transform name="to_world"><scale value="0.3"/><translate x="0.5" z="0.4"/></transform></shape>
  </scene>)");
  const auto render = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments = {"render", file, "--size", "8x8", "-o", image_of("a"), "--checkpoint", checkpoint_of("a")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_oclair(arguments);
  };
  ASSERT_EQ(render({"--spp", "4"}).exit, 0);
  const std::map<std::string, std::vector<std::string>> others = {
      {"fresnel", {"schlick"}}, {"oren-nayar", {"full", "qualitative"}}, {"max-depth", {"5"}}, {"rr-depth", {"4"}}, {"light-sampling", {"bsdf"}},
      {"sampler", {"independent"}}, {"clamp", {"0.5"}}, {"kernels", {"exact"}}, {"arithmetic", {"double"}}, {"bvh-width", {"4"}}};
  for (const Choice& choice : choices()) {
    ASSERT_EQ(others.count(choice.name), 1u) << choice.name << " is new: give values of it that are not its default";
    if (choice.name == std::string("arithmetic") && open_device().device.getInfo<CL_DEVICE_DOUBLE_FP_CONFIG>() == 0) continue;
    for (const std::string& value : others.at(choice.name)) {
      const ProgramResult result = render({"--spp", "8", "--resume", "--" + std::string(choice.name), value});
      EXPECT_EQ(result.exit, choice.effect == Effect::none ? 0 : 1) << choice.name << " " << value << ": " << result.err;
    }
  }
}

}  // namespace
