// The main function of every test program, and what each case costs.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>
#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>

#include "core/system/kept_memory.hpp"

namespace {

/// Processor seconds of this program and of the programs it has waited for.
double processor_time() {
  double seconds = 0;
  for (int const who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    getrusage(who, &usage);
    seconds += static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
               1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
  }
  return seconds;
}

/// The memory of tests is that of the program. Appends `seconds file: name` of each case to the file that SYSID_TEST_TIMES names.
/// Unlike doctest's durations these hold on a machine that does something else, too.
struct ProcessorTimes final : doctest::IReporter {
  explicit ProcessorTimes(doctest::ContextOptions const&) {}
  void test_case_start(doctest::TestCaseData const& test) override {
    current = &test;
    start = processor_time();
  }
  void test_case_end(doctest::CurrentTestCaseStats const&) override {
    char const* const path = std::getenv("SYSID_TEST_TIMES");
    if (path == nullptr) return;
    if (std::FILE* const file = std::fopen(path, "a")) {
      std::fprintf(file, "%8.3f %s: %s\n", processor_time() - start, current->m_file.c_str(), current->m_name);
      std::fclose(file);
    }
  }
  void report_query(doctest::QueryData const&) override {}
  void test_run_start() override { sysid::keep_freed_memory(); }
  void test_run_end(doctest::TestRunStats const&) override {}
  void test_case_reenter(doctest::TestCaseData const&) override {}
  void test_case_exception(doctest::TestCaseException const&) override {}
  void subcase_start(doctest::SubcaseSignature const&) override {}
  void subcase_end() override {}
  void log_assert(doctest::AssertData const&) override {}
  void log_message(doctest::MessageData const&) override {}
  void test_case_skipped(doctest::TestCaseData const&) override {}

 private:
  doctest::TestCaseData const* current = nullptr;
  double start = 0;
};

REGISTER_LISTENER("processor_times", 1, ProcessorTimes);

}  // namespace
