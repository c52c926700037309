#include <gtest/gtest.h>

#include <algorithm>

#include "program.h"

namespace {

using Arguments = std::vector<std::string>;

TEST(command_test, help_goes_to_stdout_and_succeeds) {
  for (const Arguments& arguments : {Arguments{"--help"}, {"render", "--help"}, {"merge", "--help"}, {"info", "-h"}, {"devices", "--help"}, {"selftest", "--help"}, {"compare", "--help"}}) {
    const ProgramResult result = run_oclair(arguments);
    EXPECT_EQ(result.exit, 0);
    EXPECT_NE(result.out.find("Usage: oclair"), std::string::npos) << result.out;
    EXPECT_EQ(result.err, "");
  }
}

TEST(command_test, help_of_render_lists_every_option) {
  const std::string help = run_oclair({"render", "--help"}).out;
  for (const char* option :
       {"SCENE", "-o,--output", "--png", "--spp", "--size", "--seed", "--max-depth", "--fresnel", "--sampler", "--device", "-D,--define"}) {
    EXPECT_NE(help.find(option), std::string::npos) << option;
  }
}

TEST(command_test, version_is_the_name_and_the_number) {
  const ProgramResult result = run_oclair({"--version"});
  EXPECT_EQ(result.exit, 0);
  EXPECT_EQ(result.out, "oclair " OCLAIR_VERSION "\n");
  EXPECT_EQ(result.err, "");
}

TEST(command_test, results_that_cannot_be_written_are_a_failure_of_output) {
  for (const Arguments& arguments : {Arguments{"--version"}, {"--help"}, {"devices"}}) {
    const ProgramResult result = run_oclair_into("/dev/full", arguments);  // every write to it fails like on a full disk
    EXPECT_EQ(result.exit, 1) << arguments[0];
    EXPECT_EQ(result.err, "oclair: standard output: cannot be written, expected room for the results\n");
  }
}

TEST(command_test, a_closed_standard_output_is_no_failure) {
  for (const Arguments& arguments : {Arguments{"--version"}, {"--help"}, {"devices"}}) {
    const ProgramResult result = run_oclair_into("", arguments);
    EXPECT_EQ(result.exit, 0) << arguments[0];
    EXPECT_EQ(result.err, "");
  }
}

struct UsageError {
  Arguments arguments;
  std::string message;
};

TEST(command_test, a_wrong_command_line_exits_with_2_and_one_line_of_what_was_given_and_expected) {
  const std::string count = "expected a whole number from 1 to 8589934592";
  const std::string size = "expected WIDTHxHEIGHT, both from 1 to 65536";
  const UsageError errors[] = {
      {{}, "a command is required: render, merge, info, devices, bench, tune, selftest or compare"},
      {{"paint"}, "paint"},
      {{"render"}, "SCENE is required"},
      {{"render", "a.xml", "b.xml"}, "b.xml"},
      {{"render", "a.xml", "--bounces", "3"}, "--bounces"},
      {{"render", "a.xml", "--spp"}, "--spp"},
      {{"render", "a.xml", "--spp", "0"}, "--spp '0': " + count},
      {{"render", "a.xml", "--spp", "-1"}, "--spp '-1': " + count},
      {{"render", "a.xml", "--spp", "1e3"}, "--spp '1e3': " + count},
      {{"render", "a.xml", "--spp", "8589934593"}, "--spp '8589934593': " + count},
      {{"render", "a.xml", "--seed", "x"}, "--seed 'x': expected a whole number from 0 to 18446744073709551615"},
      {{"render", "a.xml", "--max-depth", "4294967296"}, "expected a whole number from 0 to 4294967295"},
      {{"render", "a.xml", "--fresnel", "fast"}, "--fresnel 'fast': expected exact or schlick"},
      {{"render", "a.xml", "--fresnel"}, "--fresnel"},
      {{"render", "a.xml", "--kernels", "all"}, "--kernels 'all': expected shared or exact"},
      {{"render", "a.xml", "--sampler", "halton"}, "--sampler 'halton': expected independent or sobol"},
      {{"render", "a.xml", "--size", "512"}, "--size '512': " + size},
      {{"render", "a.xml", "--size", "0x512"}, "--size '0x512': " + size},
      {{"render", "a.xml", "--size", "512x65537"}, "--size '512x65537': " + size},
      {{"render", "a.xml", "--size", "512x512x3"}, "--size '512x512x3': " + size},
      {{"render", "a.xml", "-o", "a.jpg"}, "--output 'a.jpg': expected a name in .exr or .png"},
      {{"render", "a.xml", "-o", "a"}, "--output 'a': expected a name in .exr or .png"},
      {{"merge", "-o", "a.exr"}, "CHECKPOINT is required"},
      {{"merge", "a"}, "--output '': expected a name in .exr or .png, or else --checkpoint"},
      {{"merge", "a", "-o", "a.jpg"}, "--output 'a.jpg': expected a name in .exr or .png"},
      {{"render", "a.xml", "-o", "a.png", "--png"}, "--output 'a.png': expected a name in .exr when there is --png"},
      {{"render", "a.xml", "--png", "a.exr"}, "--png 'a.exr': expected a name in .png"},
      {{"render", "a.xml", "-D", "spp"}, "-D 'spp': expected NAME=VALUE"},
      {{"render", "a.xml", "-D", "=3"}, "-D '=3': expected NAME=VALUE"},
      {{"info"}, "SCENE is required"},
      {{"info", "a.xml", "-D", "spp"}, "-D 'spp': expected NAME=VALUE"},
      {{"devices", "all"}, "all"},
  };
  for (const auto& [arguments, message] : errors) {
    const ProgramResult result = run_oclair(arguments);
    EXPECT_EQ(result.exit, 2) << message;
    EXPECT_EQ(result.out, "") << message;
    EXPECT_EQ(result.err.find("oclair: "), 0u) << result.err;
    EXPECT_NE(result.err.find(message), std::string::npos) << result.err << "expected: " << message;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
}

}  // namespace
