#include "tandem/motion/joint_path.h"
