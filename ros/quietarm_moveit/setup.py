"""Install the package by colcon."""

from setuptools import find_packages, setup

NAME = "quietarm_moveit"

setup(
    name=NAME,
    version="2.1.0",
    packages=find_packages(),
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml", "README.md"]),
        (f"share/{NAME}/launch", ["launch/replanner.launch.py"]),
        (f"share/{NAME}/config", ["config/replanner.yaml"]),
    ],
    install_requires=["setuptools"],
    zip_safe=False,  # the planner's file is run by another Python
    maintainer="The quietarm developers",
    maintainer_email="quietarm@example.org",
    description="Trajectories of MoveIt planned anew by quietarm",
    license="MIT",
    entry_points={"console_scripts": ["replanner = quietarm_moveit.replanner:main"]},
)
