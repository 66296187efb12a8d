#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <Eigen/Core>

int main(int argument_count, char** arguments) {
  Eigen::setCpuCacheSizes(32 * 1024, 256 * 1024,
                          2048 * 1024);  // as the program does: sums of products must not depend on the processor
  return doctest::Context(argument_count, arguments).run();
}
