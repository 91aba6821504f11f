#include "client/bench/bench.h"
#include "client/engine/program.h"

int main(int argc, char** argv) {
    return terray::runProgram("terray-bench", argc, argv, terray::runBench);
}
