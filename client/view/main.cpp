#include "client/engine/program.h"
#include "client/view/view.h"

int main(int argc, char** argv) {
    return terray::runProgram("terray-view", argc, argv, terray::runView);
}
